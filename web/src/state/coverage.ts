// How well the places of a scan have been seen, by the confidence of their points: about the number of frames that saw them well.

// A point is kept from a confidence of 3 on. The noise of a mean falls with the square root: at 12 it is half of what it was there.
export const lowConfidence = 6; // below it: needs another look; as on the page of the quality
export const goodConfidence = 12; // from there on: scanned well

export interface Coverage {
  readonly low: number; // shares of all points; together 1
  readonly fair: number;
  readonly good: number;
}

// `counts`: points by their eighths of confidence. Null: there are no points.
export function coverageOf(counts: Uint32Array): Coverage | null {
  const sum = (from: number, to: number): number => counts.subarray(8 * from, 8 * to).reduce((total, count) => total + count, 0);
  const [low, fair, good] = [sum(0, lowConfidence), sum(lowConfidence, goodConfidence), sum(goodConfidence, counts.length / 8)];
  const all = low + fair + good;
  return all === 0 ? null : { low: low / all, fair: fair / all, good: good / all };
}
