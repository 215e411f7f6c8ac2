// Sizes of a model that follow from its surface alone. Pure functions.
import { dot, threeOf, type Axes, type Triple } from './axes';
import { GroundPlan, planSquare_m, type Corners } from './ground_plan';
import type { Surface } from './section';

export { planSquare_m };

export interface ModelFigures {
  readonly area_m2: number; // of the surface
  // Of the squares that have surface in them, seen from above; null: there are too many squares, or
  // too much surface in them.
  readonly plan_m2: number | null;
  // Of these squares, how many have floor in them; null: no floor is known.
  readonly floorShare: number | null;
}

export interface Extent {
  readonly low_m: Triple; // along, up, across
  readonly high_m: Triple;
}

// Points of a model, each with how much of it is there; null: all with the same.
export interface Weighted {
  readonly positions_m: Float32Array;
  readonly weights: Float32Array | null;
}

const most_weighed = 30_000; // triangles
const floorFacing = 0.8; // cosine between up and what is floor

// Of points, along these axes, without the farthest at either end that have `strayShare` of the
// weight: a few stray points are no room.
export function extentOf(
  { positions_m, weights }: Weighted,
  axes: Axes,
  strayShare: number,
): Extent | null {
  const count = positions_m.length / 3;
  if (count === 0) return null;
  const stray = strayShare * (weights?.reduce((sum, weight) => sum + weight, 0) ?? count);
  const [low, high] = [
    [0, 0, 0],
    [0, 0, 0],
  ];
  threeOf(axes).forEach((axis, k) => {
    const along_m = Float32Array.from({ length: count }, (_, i) =>
      dot(pointAt(positions_m, i), axis),
    );
    const order = Uint32Array.from({ length: count }, (_, i) => i).sort(
      (i, j) => along_m[i]! - along_m[j]!,
    );
    low[k] = along_m[beyond(order, weights, stray)]!;
    high[k] = along_m[beyond(order.reverse(), weights, stray)]!;
  });
  return { low_m: low as unknown as Triple, high_m: high as unknown as Triple };
}

// The first in this order that has more than `stray` of the weight up to it, itself included.
function beyond(order: Uint32Array, weights: Float32Array | null, stray: number): number {
  let sum = 0;
  for (const i of order) {
    sum += weights?.[i] ?? 1;
    if (sum > stray) return i;
  }
  return order.at(-1)!;
}

// Corners of triangles, evenly taken, each with a third of the area: where vertices are dense
// there is no more surface.
export function weighedByArea(surfaces: readonly Surface[]): Weighted {
  const triangles = surfaces.reduce((sum, { index }) => sum + Math.floor(index.length / 3), 0);
  const stride = Math.max(1, Math.ceil(triangles / most_weighed));
  const [positions_m, weights]: [number[], number[]] = [[], []];
  for (const { positions_m: all_m, index } of surfaces)
    for (let i = 0; i + 2 < index.length; i += 3 * stride) {
      const corners = [
        pointAt(all_m, index[i]!),
        pointAt(all_m, index[i + 1]!),
        pointAt(all_m, index[i + 2]!),
      ] as const;
      const third = Math.hypot(...normalOf(corners)) / 6;
      for (const corner of corners) {
        positions_m.push(...corner);
        weights.push(third);
      }
    }
  return { positions_m: Float32Array.from(positions_m), weights: Float32Array.from(weights) };
}

export function figuresOf(
  surfaces: readonly Surface[],
  axes: Axes,
  extent: Extent,
  floor_m: number | null,
): ModelFigures {
  const [along, up, across] = threeOf(axes);
  let plan = GroundPlan.over(extent);
  let area_m2 = 0;
  for (const { positions_m, index } of surfaces)
    for (let i = 0; i + 2 < index.length; i += 3) {
      const corners = [
        pointAt(positions_m, index[i]!),
        pointAt(positions_m, index[i + 1]!),
        pointAt(positions_m, index[i + 2]!),
      ] as const;
      const normal = normalOf(corners);
      const twice_m2 = Math.hypot(...normal);
      area_m2 += twice_m2 / 2;
      if (!plan || twice_m2 === 0) continue;
      const isFloor = floor_m !== null && dot(normal, up) > floorFacing * twice_m2;
      const seen = corners.map(
        (corner): Triple => [dot(corner, along), dot(corner, up), dot(corner, across)],
      ) as unknown as Corners;
      if (!plan.mark(seen, isFloor ? floor_m : null)) plan = null;
    }
  const { surface, floor } = plan?.counts() ?? { surface: 0, floor: 0 };
  return {
    area_m2,
    plan_m2: plan && surface * planSquare_m ** 2,
    floorShare: floor_m === null || surface === 0 ? null : floor / surface,
  };
}

function normalOf([a, b, c]: Corners): Triple {
  const [ab, ac] = [minus(b, a), minus(c, a)];
  return [
    ab[1] * ac[2] - ab[2] * ac[1],
    ab[2] * ac[0] - ab[0] * ac[2],
    ab[0] * ac[1] - ab[1] * ac[0],
  ];
}

const minus = (a: Triple, b: Triple): Triple => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const pointAt = (positions_m: ArrayLike<number>, i: number): Triple => [
  positions_m[3 * i]!,
  positions_m[3 * i + 1]!,
  positions_m[3 * i + 2]!,
];

// The longest length that reads well and is at most a third of an image.
export function scaleBar_m(width_m: number): number {
  const power = 10 ** Math.floor(Math.log10(width_m / 3));
  return [5, 2, 1].map((step) => step * power).find((length_m) => length_m <= width_m / 3) ?? power;
}
