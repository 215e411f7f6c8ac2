// Where to stand so that a scan is seen as a whole. World: x right, y down, z
// forward of the first camera.

export interface Box {
  readonly min_m: readonly [number, number, number];
  readonly max_m: readonly [number, number, number];
  readonly weight: number; // points in it
}

export interface Framing {
  readonly center_m: readonly [number, number, number];
  readonly radius_m: number;
  readonly floor_y_m: number; // the lowest part; y points down
}

// A few stray points behind a window must not push the room away: this share of the points is left
// out at either end of each axis.
const strayShare = 0.01;

// A handful of points is the beginning of a room rather than a very small thing.
const beginning_points = 2000;
const beginningRadius_m = 1.5;
const smallestRadius_m = 0.1;

// Null when there is nothing to look at.
export function framingOf(boxes: readonly Box[]): Framing | null {
  const filled = boxes.filter((box) => box.weight > 0);
  if (filled.length === 0) return null;
  const low = [0, 1, 2].map((axis) => quantile(filled, strayShare, (box) => box.min_m[axis]!));
  const high = [0, 1, 2].map((axis) => quantile(filled, 1 - strayShare, (box) => box.max_m[axis]!));
  const center_m = [0, 1, 2].map((axis) => (low[axis]! + high[axis]!) / 2) as [
    number,
    number,
    number,
  ];
  const points = filled.reduce((sum, box) => sum + box.weight, 0);
  const atLeast_m = points < beginning_points ? beginningRadius_m : smallestRadius_m;
  const radius_m = Math.max(
    atLeast_m,
    Math.hypot(high[0]! - low[0]!, high[1]! - low[1]!, high[2]! - low[2]!) / 2,
  );
  return { center_m, radius_m, floor_y_m: high[1]! };
}

// Distance from which a sphere fills the narrower side of the view.
export function fittingDistance_m(
  radius_m: number,
  verticalFov_rad: number,
  aspect: number,
): number {
  const horizontalFov_rad = 2 * Math.atan(Math.tan(verticalFov_rad / 2) * aspect);
  return radius_m / Math.sin(Math.min(verticalFov_rad, horizontalFov_rad) / 2);
}

function quantile(boxes: readonly Box[], share: number, value: (box: Box) => number): number {
  const sorted = [...boxes].sort((a, b) => value(a) - value(b));
  const total = sorted.reduce((sum, box) => sum + box.weight, 0);
  let seen = 0;
  for (const box of sorted) {
    seen += box.weight;
    if (seen >= share * total) return value(box);
  }
  return value(sorted[sorted.length - 1]!);
}
