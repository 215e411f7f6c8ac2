import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { backoffDelay_ms, firstDelay_ms, longestDelay_ms, shortestDelay_ms } from './backoff';

describe('backoffDelay_ms', () => {
  it('stays between its shortest and longest delay, however often it failed', () => {
    fc.assert(
      fc.property(
        fc.integer({ min: 1, max: 10_000 }),
        fc.double({ min: 0, max: 0.999999, noNaN: true }),
        (failures, random) => {
          const delay_ms = backoffDelay_ms(failures, random);
          expect(delay_ms).toBeGreaterThanOrEqual(shortestDelay_ms);
          expect(delay_ms).toBeLessThanOrEqual(longestDelay_ms);
        },
      ),
    );
  });

  it('doubles its ceiling with every failure until the longest', () => {
    const ceilings = [1, 2, 3, 4, 5, 6, 7, 8].map((failures) => backoffDelay_ms(failures, 1));
    expect(ceilings).toEqual([
      firstDelay_ms,
      1000,
      2000,
      4000,
      8000,
      16_000,
      longestDelay_ms,
      longestDelay_ms,
    ]);
  });
});
