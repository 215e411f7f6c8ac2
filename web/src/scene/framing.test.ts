import { describe, expect, it } from 'vitest';
import { fittingDistance_m, framingOf, type Box } from './framing';

const cube = (x: number, weight: number): Box => ({
  min_m: [x, 0, 0],
  max_m: [x + 1, 1, 1],
  weight,
});

describe('framingOf', () => {
  it('is the middle of all boxes, with the floor at the largest y', () => {
    const framing = framingOf([cube(0, 5000), cube(3, 5000)])!;
    expect(framing.center_m).toEqual([2, 0.5, 0.5]);
    expect(framing.radius_m).toBeCloseTo(Math.hypot(4, 1, 1) / 2);
    expect(framing.floor_y_m).toBe(1);
  });

  it('is not moved by a few stray points', () => {
    const stray: Box = { min_m: [90, 90, 90], max_m: [91, 91, 91], weight: 30 };
    expect(framingOf([cube(0, 10_000), stray])).toEqual(framingOf([cube(0, 10_000)]));
  });

  it('does not come close to the first few points of a scan', () => {
    const point: Box = { min_m: [0, 0, 1], max_m: [0.01, 0.01, 1.01], weight: 1 };
    expect(framingOf([point])!.radius_m).toBeGreaterThan(1);
    expect(framingOf([{ ...point, weight: 5000 }])!.radius_m).toBeLessThan(0.2);
  });

  it('is nothing without points', () => {
    expect(framingOf([])).toBeNull();
    expect(framingOf([cube(0, 0)])).toBeNull();
  });
});

describe('fittingDistance_m', () => {
  it('lets the sphere touch the border of the narrower side', () => {
    expect(fittingDistance_m(1, Math.PI / 2, 2)).toBeCloseTo(Math.SQRT2);
    expect(fittingDistance_m(1, Math.PI / 2, 0.5)).toBeGreaterThan(Math.SQRT2);
  });
});
