import { expect, test } from 'vitest';
import { extentOf, figuresOf, scaleBar_m, weighedByArea } from './model_figures';

const axes = { along: [1, 0, 0], up: [0, -1, 0] } as const; // across is -z
// A floor of 2 m x 1 m, seen from above, and a wall of 1 m on it.
const positions_m = Float32Array.of(0, 0, 0, 2, 0, 0, 2, 0, 1, 0, 0, 1, 0, -1, 0, 0, -1, 1);
const index = [0, 1, 2, 0, 2, 3, 0, 3, 5, 0, 5, 4];

test('areas and the ground plan follow from the triangles', () => {
  const extent = extentOf({ positions_m, weights: null }, axes, 0)!;
  expect([extent.low_m, extent.high_m]).toEqual([
    [0, 0, -1],
    [2, 1, 0],
  ]);
  const figures = figuresOf([{ positions_m, index }], axes, extent, 0);
  expect(figures.area_m2).toBeCloseTo(3);
  expect(figures.plan_m2).toBeCloseTo(2, 1);
  const facing = figuresOf([{ positions_m, index: [0, 2, 1, 0, 3, 2] }], axes, extent, 0);
  // From one side it is a floor.
  expect([figures.floorShare, facing.floorShare].sort()).toEqual([0, 1]);
  expect(figuresOf([{ positions_m, index }], axes, extent, null).floorShare).toBeNull();
});

test('stray points are no extent', () => {
  const many = Float32Array.from({ length: 3000 }, (_, i) => (i < 3 ? 50 : (i % 100) / 100));
  expect(extentOf({ positions_m: many, weights: null }, axes, 0.005)!.high_m[0]).toBeLessThan(1);
  expect(extentOf({ positions_m: new Float32Array(), weights: null }, axes, 0.005)).toBeNull();
});

test('of a surface its area counts, not its vertices', () => {
  // A wall of two triangles, 4 m long, and beside its beginning a vase of a thousand small ones.
  const wall = {
    positions_m: Float32Array.of(0, 0, 0, 4, 0, 0, 4, -2, 0, 0, -2, 0),
    index: [0, 1, 2, 0, 2, 3],
  };
  const vase = {
    positions_m: Float32Array.of(0, 0, 0, 0.01, 0, 0, 0, -0.01, 0),
    index: Array.from({ length: 3000 }, (_, i) => i % 3),
  };
  const weighed = weighedByArea([wall, vase]);
  expect(extentOf(weighed, axes, 0.005)!.high_m[0]).toBeCloseTo(4);
  expect(extentOf({ ...weighed, weights: null }, axes, 0.005)!.high_m[0]).toBeCloseTo(0.01);
  const stray = {
    positions_m: Float32Array.of(50, 0, 0, 50.1, 0, 0, 50, -0.1, 0),
    index: [0, 1, 2],
  };
  expect(extentOf(weighedByArea([wall, stray]), axes, 0.005)!.high_m[0]).toBeCloseTo(4);
});

test('scale bars read well', () => {
  expect([5, 0.35, 90, 3].map(scaleBar_m)).toEqual([1, 0.1, 20, 1]);
});
