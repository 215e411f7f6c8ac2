// How well the places of a scan have been seen, by the confidence of their points, or of the
// vertices of the surface while that is shown: about the number of frames that saw them well.
// Vertices have the mean of the points around them.

// A point is kept from a confidence of 3 on. The noise of a mean falls with the square root: at 12
// it is half of what it was there.
export const lowConfidence = 6; // below it: needs another look; as on the page of the quality
export const goodConfidence = 12; // from there on: scanned well

export interface Coverage {
  readonly low: number; // shares of all points or vertices; together 1
  readonly fair: number;
  readonly good: number;
}

// `counts`: points or vertices by their eighths of confidence. Null: there are none.
export function coverageOf(counts: Uint32Array): Coverage | null {
  const sum = (from: number, to: number): number =>
    counts.subarray(8 * from, 8 * to).reduce((total, count) => total + count, 0);
  const [low, fair, good] = [
    sum(0, lowConfidence),
    sum(lowConfidence, goodConfidence),
    sum(goodConfidence, counts.length / 8),
  ];
  const all = low + fair + good;
  return all === 0 ? null : { low: low / all, fair: fair / all, good: good / all };
}
