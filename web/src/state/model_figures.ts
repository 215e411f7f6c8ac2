// Sizes of a model that follow from its surface alone. Pure functions.
import { dot, threeOf, type Axes, type Triple } from './axes';
import { GroundPlan, planSquare_m, type Corners } from './ground_plan';
import type { Surface } from './section';

export { planSquare_m };

export interface ModelFigures {
  readonly area_m2: number; // of the surface
  readonly plan_m2: number | null; // of the squares that have surface in them, seen from above; null: there are too many squares, or too much surface in them
  readonly floorShare: number | null; // of these, how many have floor in them; null: no floor is known
}

export interface Extent {
  readonly low_m: Triple; // along, up, across
  readonly high_m: Triple;
}

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

export function figuresOf(surfaces: readonly Surface[], axes: Axes, extent: Extent, floor_m: number | null): ModelFigures {
  const [along, up, across] = threeOf(axes);
  let plan = GroundPlan.over(extent);
  let area_m2 = 0;
  for (const { positions_m, index } of surfaces)
    for (let i = 0; i + 2 < index.length; i += 3) {
      const corners = [pointAt(positions_m, index[i]!), pointAt(positions_m, index[i + 1]!), pointAt(positions_m, index[i + 2]!)] as const;
      const normal = normalOf(corners);
      const twice_m2 = Math.hypot(...normal);
      area_m2 += twice_m2 / 2;
      if (!plan || twice_m2 === 0) continue;
      const isFloor = floor_m !== null && dot(normal, up) > floorFacing * twice_m2;
      const seen = corners.map((corner): Triple => [dot(corner, along), dot(corner, up), dot(corner, across)]) as unknown as Corners;
      if (!plan.mark(seen, isFloor ? floor_m : null)) plan = null;
    }
  const { surface, floor } = plan?.counts() ?? { surface: 0, floor: 0 };
  return { area_m2, plan_m2: plan && surface * planSquare_m ** 2, floorShare: floor_m === null || surface === 0 ? null : floor / surface };
}

function normalOf([a, b, c]: Corners): Triple {
  const [ab, ac] = [minus(b, a), minus(c, a)];
  return [ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2], ab[0] * ac[1] - ab[1] * ac[0]];
}

const minus = (a: Triple, b: Triple): Triple => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const pointAt = (positions_m: ArrayLike<number>, i: number): Triple => [positions_m[3 * i]!, positions_m[3 * i + 1]!, positions_m[3 * i + 2]!];

// The longest length that reads well and is at most a third of a picture.
export function scaleBar_m(width_m: number): number {
  const power = 10 ** Math.floor(Math.log10(width_m / 3));
  return [5, 2, 1].map((step) => step * power).find((length_m) => length_m <= width_m / 3) ?? power;
}
