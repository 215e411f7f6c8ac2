// The directions of a model in the world frame of the scan: up, the horizontal direction that most
// walls face, and the one at right angles to both. Pure functions.

export type Triple = readonly [number, number, number];

// Unit vectors at right angles.
export interface Axes {
  readonly along: Triple;
  readonly up: Triple;
}

export function dot(a: Triple, b: Triple): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function cross(a: Triple, b: Triple): Triple {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function combined(a: Triple, times: number, b: Triple, timesB: number): Triple {
  return [a[0] * times + b[0] * timesB, a[1] * times + b[1] * timesB, a[2] * times + b[2] * timesB];
}

export function unit(a: Triple): Triple {
  const length = Math.hypot(...a);
  return [a[0] / length, a[1] / length, a[2] / length];
}

// Along, up, across: right-handed.
export function threeOf({ along, up }: Axes): readonly [Triple, Triple, Triple] {
  return [along, up, cross(along, up)];
}

// Returns axes with this `up`, and `along` as close to `wish` as possible.
export function axesOf(up: Triple, wish: Triple): Axes {
  const flat = combined(wish, 1, up, -dot(wish, up));
  if (Math.hypot(...flat) > 1e-3) return { along: unit(flat), up };
  const other: Triple = Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1];
  return { along: unit(combined(other, 1, up, -dot(other, up))), up };
}
