import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import type { Triple } from './axes';
import { GroundPlan } from './ground_plan';

const extent = (size_m: number) => ({
  low_m: [0, 0, 0] as const,
  high_m: [size_m, 3, size_m] as const,
});

describe('GroundPlan', () => {
  it('has no holes in triangles of any size', () => {
    for (const size_m of [0.1, 5, 60, 300]) {
      const plan = GroundPlan.over(extent(size_m))!;
      expect(
        plan.mark(
          [
            [0, 0, 0],
            [size_m, 0, 0],
            [size_m, 0, size_m],
          ],
          0,
        ),
      ).toBe(true);
      expect(
        plan.mark(
          [
            [0, 0, 0],
            [0, 0, size_m],
            [size_m, 0, size_m],
          ],
          0,
        ),
      ).toBe(true);
      expect(plan.counts()).toEqual({
        surface: Math.round(10 * size_m) ** 2,
        floor: Math.round(10 * size_m) ** 2,
      });
    }
  });

  it('has a line of squares for a wall, also where it stands on the border', () => {
    for (const z_m of [0, 0.35, 1]) {
      const plan = GroundPlan.over(extent(1))!;
      plan.mark(
        [
          [0, 0, z_m],
          [1, 0, z_m],
          [1, 3, z_m],
        ],
        null,
      );
      expect(plan.counts()).toEqual({ surface: 10, floor: 0 });
    }
  });

  it('takes of a ramp for floor what is as high', () => {
    const plan = GroundPlan.over(extent(1))!;
    plan.mark(
      [
        [0, 0, 0],
        [1, 0.5, 0],
        [1, 0.5, 1],
      ],
      0,
    );
    plan.mark(
      [
        [0, 0, 0],
        [0, 0, 1],
        [1, 0.5, 1],
      ],
      0,
    );
    const { surface, floor } = plan.counts();
    expect(surface).toBe(100);
    expect(floor).toBeGreaterThanOrEqual(5);
    expect(floor).toBeLessThanOrEqual(30);
  });

  it('gives up where it is too much, and leaves out what is outside', () => {
    expect(GroundPlan.over(extent(1000))).toBeNull();
    const plan = GroundPlan.over(extent(10), 25_000)!;
    const half: [Triple, Triple, Triple] = [
      [0, 0, 0],
      [10, 0, 0],
      [10, 0, 10],
    ];
    expect(Array.from({ length: 10 }, () => plan.mark(half, null)).indexOf(false)).toBe(4);
    const beside = GroundPlan.over(extent(1))!;
    for (const [x, z] of [
      [2, 0],
      [0, 2],
      [-2, 0],
      [0, -2],
    ] as const)
      beside.mark(
        [
          [x, 0, z],
          [x + 0.5, 0, z],
          [x + 0.5, 0, z + 0.5],
        ],
        null,
      );
    expect(beside.counts().surface).toBe(0);
  });

  it('marks whatever square a point of the triangle is in', () => {
    const at = fc.double({ min: 0, max: 2, noNaN: true });
    const share = fc.double({ min: 0.01, max: 0.98, noNaN: true });
    fc.assert(
      fc.property(
        fc.array(at, { minLength: 6, maxLength: 6 }),
        share,
        share,
        ([ax, az, bx, bz, cx, cz], s, t) => {
          const plan = GroundPlan.over(extent(2))!;
          plan.mark(
            [
              [ax!, 0, az!],
              [bx!, 0, bz!],
              [cx!, 0, cz!],
            ],
            null,
          );
          const { surface } = plan.counts();
          const [u, v] = [s * (1 - t), s * t];
          const [x, z] = [
            ax! + u * (bx! - ax!) + v * (cx! - ax!),
            az! + u * (bz! - az!) + v * (cz! - az!),
          ];
          // Values on a border of squares are left out.
          const isInside = (value: number): boolean => Math.abs(((10 * value) % 1) - 0.5) < 0.49;
          if (!isInside(x) || !isInside(z)) return;
          plan.mark(
            [
              [x, 0, z],
              [x, 0, z],
              [x, 0, z],
            ],
            null,
          );
          expect(plan.counts().surface).toBe(surface);
        },
      ),
    );
  });
});
