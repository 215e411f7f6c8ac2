// Full-jitter backoff between attempts to connect: half a second at most first, thirty seconds at
// most later, never less than a quarter.

export const firstDelay_ms = 500;
export const longestDelay_ms = 30_000;
export const shortestDelay_ms = 250;

// `failures` in a row so far (1 after the first), `random` in [0, 1).
export function backoffDelay_ms(failures: number, random: number): number {
  const ceiling_ms = Math.min(longestDelay_ms, firstDelay_ms * 2 ** Math.min(failures - 1, 16));
  return Math.max(shortestDelay_ms, Math.round(ceiling_ms * random));
}
