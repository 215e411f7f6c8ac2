import { describe, expect, it } from 'vitest';
import { cross, dot, type Triple } from '../state/axes';
import type { SurfaceSamples } from './gravity';
import { hasWalls, wallAxes } from './heading';

const samplesOf = (normals: readonly Triple[]): SurfaceSamples => ({
  count: normals.length,
  positions_m: new Float32Array(3 * normals.length),
  normals: Float32Array.from(normals.flat()),
  weights: new Float32Array(normals.length).fill(1),
});
const up = [0, -1, 0] as const;
const facing = (angle_deg: number): Triple => [
  Math.cos((angle_deg * Math.PI) / 180),
  0,
  Math.sin((angle_deg * Math.PI) / 180),
];

describe('wallAxes', () => {
  it.each([0, 3, 30, 44, -20, 89.5])(
    'finds walls that are turned by %d degrees, among floors and clutter',
    (turn_deg) => {
      const noise = (i: number): number => ((i * 37) % 11) / 5 - 1;
      const walls = Array.from({ length: 400 }, (_, i) =>
        facing(turn_deg + 90 * (i % 4) + noise(i)),
      );
      const clutter = Array.from({ length: 180 }, (_, i) => facing(2 * i + 1));
      const { along } = wallAxes(samplesOf([...walls, ...clutter, up, up]), up);
      const wall = facing(turn_deg);
      const best = Math.max(Math.abs(dot(along, wall)), Math.abs(dot(along, cross(wall, up))));
      expect((Math.acos(Math.min(1, best)) * 180) / Math.PI).toBeLessThan(0.5);
      expect(along[0]).toBeGreaterThan(0.7);
      expect(dot(along, up)).toBeCloseTo(0);
    },
  );

  it.each([29.999, 30, 45])('finds walls without any noise, at %d degrees', (turn_deg) => {
    const { along } = wallAxes(samplesOf([facing(turn_deg), facing(turn_deg + 90)]), up);
    expect(
      Math.max(Math.abs(dot(along, facing(turn_deg))), Math.abs(dot(along, facing(turn_deg + 90)))),
    ).toBeCloseTo(1, 6);
  });

  it('is the world’s x where there are no walls', () => {
    expect(wallAxes(samplesOf([up]), up).along).toEqual([1, 0, 0]);
    expect([[up], [up, facing(30)], []].map((normals) => hasWalls(samplesOf(normals), up))).toEqual(
      [false, true, false],
    );
  });
});
