import { expect, test } from 'vitest';
import { parseMeasured, parseMeasurements } from './measurements';

const one = { id: 'a', name: 'Door', from: [0, 0, 1], to: [0, 0, 2.5], words: '1.500 m ± 0.002 m (95 %)', distance_m: 1.5 };

test('what the server has measured is read', () => {
  expect(parseMeasured(one)).toEqual({ from: [0, 0, 1], to: [0, 0, 2.5], words: one.words });
  for (const wrong of [null, {}, { ...one, from: [0, 1] }, { ...one, to: [0, 0, 'x'] }, { ...one, words: 5 }]) expect(() => parseMeasured(wrong)).toThrow();
});

test('what is no measurement is left out of the list', () => {
  const { distance_m: _, ...kept } = one;
  expect(parseMeasurements({ measurements: [one, null, { ...one, id: '' }, { ...one, from: 'x' }] })).toEqual([kept]);
  expect(() => parseMeasurements({})).toThrow();
});
