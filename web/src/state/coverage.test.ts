import { describe, expect, it } from 'vitest';
import { coverageOf, goodConfidence, lowConfidence } from './coverage';

describe('coverage', () => {
  const counted = (...confidences: number[]): Uint32Array => {
    const counts = new Uint32Array(256);
    for (const confidence of confidences) counts[8 * confidence]! += 1;
    return counts;
  };
  it('is told in shares of the points', () => {
    expect(coverageOf(counted(3, lowConfidence, goodConfidence, 31))).toEqual({
      low: 0.25,
      fair: 0.25,
      good: 0.5,
    });
  });
  it('has its limits where the next kind begins', () => {
    expect(coverageOf(counted(lowConfidence - 0.125))!.low).toBe(1);
    expect(coverageOf(counted(goodConfidence - 0.125))!.fair).toBe(1);
  });
  it('is none without points', () => {
    expect(coverageOf(new Uint32Array(256))).toBeNull();
  });
});
