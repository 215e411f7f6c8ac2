// Sizes of a model that follow from its surface alone. Pure functions.
import { dot, threeOf, type Axes, type Triple } from './axes';
import type { Surface } from './section';

export interface ModelFigures {
  readonly area_m2: number; // of the surface
  readonly plan_m2: number | null; // of the squares that have surface in them, seen from above; null: there are too many squares
  readonly floorShare: number | null; // of these, how many have floor in them; null: no floor is known
}

export interface Extent {
  readonly low_m: Triple; // along, up, across
  readonly high_m: Triple;
}

export const planSquare_m = 0.1;
const most_squares = 1 << 24;
const floorWithin_m = 0.06;
const floorFacing = 0.8; // cosine between up and what is floor

// Of points, along these axes, without the farthest `strayShare` at either end: a few stray points are no room.
export function extentOf(positions_m: Float32Array, axes: Axes, strayShare: number): Extent | null {
  const count = positions_m.length / 3;
  if (count === 0) return null;
  const [low, high] = [[0, 0, 0], [0, 0, 0]];
  threeOf(axes).forEach((axis, k) => {
    const along_m = Float32Array.from({ length: count }, (_, i) => dot(pointAt(positions_m, i), axis)).sort();
    const left = Math.min(Math.floor(strayShare * count), Math.floor((count - 1) / 2));
    low[k] = along_m[left]!;
    high[k] = along_m[count - 1 - left]!;
  });
  return { low_m: low as unknown as Triple, high_m: high as unknown as Triple };
}

export function figuresOf(surfaces: readonly Surface[], axes: Axes, { low_m, high_m }: Extent, floor_m: number | null): ModelFigures {
  const [along, up, across] = threeOf(axes);
  const [columns, rows] = [0, 2].map((k) => Math.max(1, Math.ceil((high_m[k]! - low_m[k]!) / planSquare_m))) as [number, number];
  const squares = columns * rows <= most_squares ? new Uint8Array(columns * rows) : null; // 1: surface, 2: floor, too
  let area_m2 = 0;
  const mark = (point: Triple, isFloor: boolean): void => {
    const column = Math.floor((dot(point, along) - low_m[0]) / planSquare_m);
    const row = Math.floor((dot(point, across) - low_m[2]) / planSquare_m);
    if (!squares || column < 0 || row < 0 || column >= columns || row >= rows) return;
    squares[row * columns + column]! |= isFloor && Math.abs(dot(point, up) - floor_m!) < floorWithin_m ? 3 : 1;
  };
  for (const { positions_m, index } of surfaces)
    for (let i = 0; i + 2 < index.length; i += 3) {
      const [a, b, c] = [pointAt(positions_m, index[i]!), pointAt(positions_m, index[i + 1]!), pointAt(positions_m, index[i + 2]!)];
      const [ab, ac] = [minus(b, a), minus(c, a)];
      const normal: Triple = [ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2], ab[0] * ac[1] - ab[1] * ac[0]];
      const twice_m2 = Math.hypot(...normal);
      area_m2 += twice_m2 / 2;
      const isFloor = floor_m !== null && dot(normal, up) > floorFacing * twice_m2;
      pointsIn(a, ab, ac, (point) => mark(point, isFloor));
    }
  const [seen, floors] = [squares?.reduce((sum, square) => sum + (square & 1), 0) ?? 0, squares?.reduce((sum, square) => sum + (square >> 1), 0) ?? 0];
  return { area_m2, plan_m2: squares && seen * planSquare_m ** 2, floorShare: floor_m === null || seen === 0 ? null : floors / seen };
}

// Of a triangle, at most half a square apart.
function pointsIn(a: Triple, ab: Triple, ac: Triple, visit: (point: Triple) => void): void {
  const longest_m = Math.max(Math.hypot(...ab), Math.hypot(...ac), Math.hypot(...minus(ab, ac)));
  const steps = Math.min(500, Math.max(1, Math.ceil((2 * longest_m) / planSquare_m)));
  for (let i = 0; i < steps; ++i)
    for (let j = 0; i + j < steps; ++j) {
      const [u, v] = [(i + 1 / 3) / steps, (j + 1 / 3) / steps];
      visit([a[0] + u * ab[0] + v * ac[0], a[1] + u * ab[1] + v * ac[1], a[2] + u * ab[2] + v * ac[2]]);
    }
}

const minus = (a: Triple, b: Triple): Triple => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const pointAt = (positions_m: ArrayLike<number>, i: number): Triple => [positions_m[3 * i]!, positions_m[3 * i + 1]!, positions_m[3 * i + 2]!];

// The longest length that reads well and is at most a third of a picture.
export function scaleBar_m(width_m: number): number {
  const power = 10 ** Math.floor(Math.log10(width_m / 3));
  return [5, 2, 1].map((step) => step * power).find((length_m) => length_m <= width_m / 3) ?? power;
}
