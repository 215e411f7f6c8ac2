// The bounds of a model along its axes.
import { threeOf, type Axes, type Triple } from '../state/axes';
import type { Box } from '../state/cutting';
import type { Surface } from '../state/section';
import type { Box as WorldBox } from './framing';

// Returns null for an empty model. Of boxes the corners count, of surfaces the vertices.
export function boundsAlong(
  axes: Axes,
  boxes: readonly WorldBox[],
  surfaces: readonly Surface[],
): Box | null {
  const directions = threeOf(axes);
  const [low, high] = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ];
  const add = (x: number, y: number, z: number): void => {
    for (let k = 0; k < 3; ++k) {
      const axis = directions[k]!;
      const value = x * axis[0] + y * axis[1] + z * axis[2];
      if (value < low[k]!) low[k] = value;
      if (value > high[k]!) high[k] = value;
    }
  };
  for (const { positions_m } of surfaces)
    for (let i = 0; i < positions_m.length; i += 3)
      add(positions_m[i]!, positions_m[i + 1]!, positions_m[i + 2]!);
  for (const { min_m, max_m, weight } of boxes) {
    if (weight === 0) continue;
    for (let i = 0; i < 8; ++i)
      add(i & 1 ? max_m[0] : min_m[0], i & 2 ? max_m[1] : min_m[1], i & 4 ? max_m[2] : min_m[2]);
  }
  return low[0]! <= high[0]!
    ? { low_m: low as unknown as Triple, high_m: high as unknown as Triple }
    : null;
}
