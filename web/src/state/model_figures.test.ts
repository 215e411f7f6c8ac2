import { expect, test } from 'vitest';
import { extentOf, figuresOf, scaleBar_m } from './model_figures';

const axes = { along: [1, 0, 0], up: [0, -1, 0] } as const; // across is -z
// A floor of 2 m x 1 m, seen from above, and a wall of 1 m on it.
const positions_m = Float32Array.of(0, 0, 0, 2, 0, 0, 2, 0, 1, 0, 0, 1, 0, -1, 0, 0, -1, 1);
const index = [0, 1, 2, 0, 2, 3, 0, 3, 5, 0, 5, 4];

test('areas and the ground plan follow from the triangles', () => {
  const extent = extentOf(positions_m, axes, 0)!;
  expect([extent.low_m, extent.high_m]).toEqual([[0, 0, -1], [2, 1, 0]]);
  const figures = figuresOf([{ positions_m, index }], axes, extent, 0);
  expect(figures.area_m2).toBeCloseTo(3);
  expect(figures.plan_m2).toBeCloseTo(2, 1);
  const facing = figuresOf([{ positions_m, index: [0, 2, 1, 0, 3, 2] }], axes, extent, 0);
  expect([figures.floorShare, facing.floorShare].sort()).toEqual([0, 1]); // from one side it is a floor
  expect(figuresOf([{ positions_m, index }], axes, extent, null).floorShare).toBeNull();
});

test('stray points are no extent', () => {
  const many = Float32Array.from({ length: 3000 }, (_, i) => (i < 3 ? 50 : (i % 100) / 100));
  expect(extentOf(many, axes, 0.005)!.high_m[0]).toBeLessThan(1);
  expect(extentOf(new Float32Array(), axes, 0.005)).toBeNull();
});

test('scale bars read well', () => {
  expect([5, 0.35, 90, 3].map(scaleBar_m)).toEqual([1, 0.1, 20, 1]);
});
