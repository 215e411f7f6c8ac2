import { Triangle, Vector3 } from 'three';
import { expect, test } from 'vitest';
import type { Measured, Place } from '../connection/measurements';
import { linesThrough, shapeOf } from './measure_shape';

const first: Place = [0, 0, 1];
const second: Place = [1, 2, 3];
const inward: Place = [0, 0, -1];
const measured = (kind: Measured['kind'], more: Partial<Measured> = {}): Measured => ({
  kind,
  points: [first, second],
  normals: [inward, inward],
  words: '',
  ...more,
});

const areaOf = (triangles: readonly Place[]): number => {
  let sum = 0;
  for (let i = 0; i < triangles.length; i += 3)
    sum += new Triangle(
      ...([0, 1, 2].map((k) => new Vector3(...triangles[i + k]!)) as [Vector3, Vector3, Vector3]),
    ).getArea();
  return sum;
};

test('a distance to a plane goes straight across to it, and on it to where it was clicked', () => {
  const { lines, triangles, labelPlace } = shapeOf(measured('plane'));
  expect(lines).toEqual([first, [0, 0, 3], [0, 0, 3], second]);
  expect(labelPlace).toEqual([0, 0, 2]);
  expect(areaOf(triangles)).toBeCloseTo(0.09);
  for (const [, , z] of triangles) expect(z).toBeCloseTo(3);
});

test('a height goes up, and then across', () => {
  expect(shapeOf(measured('height', { up: [0, -1, 0] })).lines).toEqual([
    first,
    [0, 2, 1],
    [0, 2, 1],
    second,
  ]);
});

test('an angle has both of its planes', () => {
  const { lines, triangles } = shapeOf(measured('angle', { normals: [inward, [1, 0, 0]] }));
  expect(lines).toEqual([first, second]);
  expect(areaOf(triangles)).toBeCloseTo(0.18);
});

test('an area has its outline and is filled, also where it goes around a corner', () => {
  const points: Place[] = [
    [0, 0, 1],
    [2, 0, 1],
    [2, 1, 1],
    [1, 1, 1],
    [1, 2, 1],
    [0, 2, 1],
  ];
  const { lines, triangles, ends } = shapeOf({ kind: 'area', points, normals: [], words: '' });
  expect(lines).toHaveLength(12);
  expect(lines.slice(-2)).toEqual([points[5], points[0]]);
  expect(areaOf(triangles)).toBeCloseTo(3);
  expect(ends).toEqual(points);
});

test('what is not closed yet is open', () => {
  expect(linesThrough([first])).toEqual([]);
  expect(linesThrough([first, second, inward])).toEqual([first, second, second, inward]);
});
