import { describe, expect, it } from 'vitest';
import { boundsAlong } from './model_bounds';

const half = Math.SQRT1_2;
const turned = { along: [half, 0, half], up: [0, -1, 0] } as const;

describe('boundsAlong', () => {
  it('holds boxes with all their corners, and surfaces with all their vertices', () => {
    const box = { min_m: [0, 0, 0], max_m: [1, 2, 1], weight: 5 } as const;
    const bounds = boundsAlong(
      turned,
      [box, { ...box, max_m: [90, 90, 90], weight: 0 }],
      [{ positions_m: [0, 3, 0], index: [] }],
    )!;
    expect(bounds.low_m[0]).toBeCloseTo(0);
    expect(bounds.high_m[0]).toBeCloseTo(Math.SQRT2);
    expect(bounds.low_m[1]).toBe(-3);
    expect(bounds.high_m[1]).toBeCloseTo(0);
    expect(bounds.high_m[2] - bounds.low_m[2]).toBeCloseTo(Math.SQRT2);
  });

  it('is nothing where nothing is', () => {
    expect(boundsAlong(turned, [], [])).toBeNull();
  });
});
