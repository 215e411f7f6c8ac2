import { expect, test } from 'vitest';
import { parseMeasured, parseMeasurements } from './measurements';

const points = [
  [0, 0, 1],
  [0, 0, 2.5],
];
const normals = [
  [0, 0, -1],
  [0, 0, -1],
];
const one = {
  id: 'a',
  name: 'Door',
  kind: 'distance',
  points,
  normals,
  words: '1.500 m ± 0.002 m (95 %)',
  value: 1.5,
};

test('what the server has measured is read', () => {
  expect(parseMeasured(one)).toEqual({ kind: 'distance', points, normals, words: one.words });
  expect(parseMeasured({ ...one, normals: [] }).normals).toEqual([]); // kept by an earlier version
  expect(parseMeasured({ ...one, kind: 'height', up: [0, -1, 0] }).up).toEqual([0, -1, 0]);
  const wrongs = [
    null,
    {},
    { ...one, points: [[0, 1]] },
    { ...one, points: [points[0]] },
    { ...one, points: [points[0], [0, 0, 'x']] },
    { ...one, words: 5 },
  ];
  const wrongKinds = [
    { ...one, kind: 'weight' },
    { ...one, kind: 'plane', normals: [] },
    { ...one, kind: 'height' },
    { ...one, up: [0, -1, 0] },
  ];
  for (const wrong of [...wrongs, ...wrongKinds]) expect(() => parseMeasured(wrong)).toThrow();
});

test('what is no measurement is left out of the list', () => {
  const { value: _, ...kept } = one;
  expect(
    parseMeasurements({ measurements: [one, null, { ...one, id: '' }, { ...one, points: 'x' }] }),
  ).toEqual([kept]);
  expect(() => parseMeasurements({})).toThrow();
});
