import { describe, expect, it } from 'vitest';
import { anchored } from './label';

describe('anchored', () => {
  it('leaves what has room as it is', () => {
    expect(anchored(0.5, 0, 0.4, 1)).toBe(0.5);
    expect(anchored(-0.3, 0.2, 0.1, 1)).toBe(-0.3);
  });

  it('moves what would leave the image back to its edge', () => {
    for (const at of [-1, -0.9, 0.9, 1]) {
      const share = anchored(0.5, at, 0.4, 0.98);
      expect(at - share * 0.4).toBeGreaterThanOrEqual(-0.98 - 1e-9);
      expect(at + (1 - share) * 0.4).toBeLessThanOrEqual(0.98 + 1e-9);
    }
    // It is below its usual place, so that it ends at the upper edge.
    expect(anchored(-0.3, 0.95, 0.1, 1)).toBeCloseTo(0.5);
  });

  it('shows the beginning of what is too wide', () => {
    expect(0.3 - anchored(0.5, 0.3, 2.5, 1) * 2.5).toBeCloseTo(-1);
  });
});
