// Finds the horizontal direction that most walls face, assuming that walls meet at
// right angles. Pure functions.
import { axesOf, combined, cross, dot, type Axes, type Triple } from '../state/axes';
import type { SurfaceSamples } from './gravity';

const quarter_deg = 90;
const around_deg = 4; // on either side of the peak
const steepest = 0.2; // sine of the largest angle between a wall and the vertical

// Returns axes with this `up`. Of the four directions that the walls face, `along` is the one
// nearest to the world's x.
export function wallAxes(samples: SurfaceSamples, up: Triple): Axes {
  const axes = axesOf(up, [1, 0, 0]);
  const across = cross(axes.along, up);
  const walls: { readonly angle_deg: number; readonly weight: number }[] = [];
  const bins = new Float64Array(quarter_deg);
  for (let i = 0; i < samples.count; ++i) {
    const normal: Triple = [
      samples.normals[3 * i]!,
      samples.normals[3 * i + 1]!,
      samples.normals[3 * i + 2]!,
    ];
    if (!isUpright(normal, up)) continue;
    const angle_deg = positive(
      (Math.atan2(dot(normal, across), dot(normal, axes.along)) * 180) / Math.PI,
    );
    walls.push({ angle_deg, weight: samples.weights[i]! });
    bins[Math.floor(angle_deg) % quarter_deg]! += samples.weights[i]!;
  }
  if (walls.length === 0) return axes;
  // Near bins have more weight, so that the peak lies in the middle of its bins.
  const nearby = (bin: number): number => {
    let sum = 0;
    for (let k = -around_deg; k <= around_deg; ++k)
      sum += (around_deg + 1 - Math.abs(k)) * bins[positive(bin + k)]!;
    return sum;
  };
  const peak_deg =
    bins.reduce((best, _, bin) => (nearby(bin) > nearby(best) ? bin : best), 0) + 0.5;
  let [sum, total] = [0, 0];
  for (const { angle_deg, weight } of walls) {
    const off_deg = positive(angle_deg - peak_deg + quarter_deg / 2) - quarter_deg / 2;
    if (Math.abs(off_deg) > around_deg) continue;
    sum += weight * off_deg;
    total += weight;
  }
  const turn_deg = positive(peak_deg + sum / total + quarter_deg / 2) - quarter_deg / 2;
  const turn_rad = (turn_deg * Math.PI) / 180;
  return axesOf(up, combined(axes.along, Math.cos(turn_rad), across, Math.sin(turn_rad)));
}

const isUpright = (normal: Triple, up: Triple): boolean => Math.abs(dot(normal, up)) <= steepest;

// Whether there is anything upright that `wallAxes` turns to.
export function hasWalls({ count, normals }: SurfaceSamples, up: Triple): boolean {
  for (let i = 0; i < count; ++i)
    if (isUpright([normals[3 * i]!, normals[3 * i + 1]!, normals[3 * i + 2]!], up)) return true;
  return false;
}

// Returns the angle modulo 90 degrees, not negative.
function positive(angle_deg: number): number {
  return ((angle_deg % quarter_deg) + quarter_deg) % quarter_deg;
}
