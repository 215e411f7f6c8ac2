// Which way is up, and where the floor is, from the normals of a surface: rooms have floors, tables
// and ceilings across gravity and walls along it. World: x right, y down, z forward of the first
// camera. Pure functions.

import type { Direction, MeasuredUp } from '../connection/events';

export type { Direction } from '../connection/events';

// Some points of the surface in the world, with unit normals that look at whoever saw them.
export interface SurfaceSamples {
  readonly count: number;
  readonly positions_m: Float32Array; // 3 a point
  readonly normals: Float32Array; // 3 a point
  readonly weights: Float32Array; // how many points each stands for
}

export const firstCamerasUp: Direction = [0, -1, 0];

const binsPerEdge = 16; // of a face of the cube around all directions: about 5 degrees each
// Where up is looked for.
export interface UpRange {
  readonly middle: Direction;
  readonly mostOff_rad: number;
}
// Nobody holds a camera further from upright.
const unmeasured: UpRange = { middle: firstCamerasUp, mostOff_rad: Math.PI / 3 };
const leastRange_rad = 0.05; // 3 degrees, which floors may slope
const rangeDeviations = 3;
const coarse_rad = 0.17; // wider than a bin
const fine_rad = [0.14, 0.09, 0.06] as const; // then the plane itself, noise included
const ceilingWorth = 0.5; // a lamp or a ceiling says less than a floor
const wallWorth = 0.35; // a direction along some wall is easily found
const enough = 0.3; // of the surface lies across or along it, else it is no room
const enoughAcross = 0.03;
const enoughSamples = 300;

export function upRange(measured: MeasuredUp | null): UpRange {
  if (!measured) return unmeasured;
  const off_rad = Math.max(leastRange_rad, rangeDeviations * measured.sigma_rad);
  return { middle: measured.inWorld, mostOff_rad: Math.min(unmeasured.mostOff_rad, off_rad) };
}

// What the surface says, or else what was measured; null: nothing is sure enough.
export function bestUp(samples: SurfaceSamples, measured: MeasuredUp | null): Direction | null {
  return upOf(samples, upRange(measured)) ?? measured?.inWorld ?? null;
}

// Null: nothing is sure enough.
export function upOf(samples: SurfaceSamples, range: UpRange = unmeasured): Direction | null {
  if (samples.count < enoughSamples) return null;
  const leastCosine = Math.cos(range.mostOff_rad);
  const bins = binned(samples);
  let best: Direction | null = null;
  let bestScore = 0;
  for (const candidate of candidates(range.middle)) {
    const cosine = dot(candidate, range.middle);
    if (cosine < leastCosine) continue;
    const { floor, ceiling, walls } = support(bins, candidate, coarse_rad);
    const score = (floor + ceilingWorth * ceiling + wallWorth * walls) * cosine * cosine;
    if (score <= bestScore) continue;
    best = candidate;
    bestScore = score;
  }
  if (!best) return null;
  for (const within_rad of fine_rad) best = refined(samples, best, within_rad);
  const { floor, ceiling, walls } = support(bins, best, coarse_rad);
  const across = floor + ceiling;
  if (dot(best, range.middle) < leastCosine || across + walls < enough || across < enoughAcross)
    return null;
  return best;
}

const layer_m = 0.03;
const floorShare = 0.08; // of all that looks up; less is clutter, or a reflection below the floor

// How high the floor lies along `up`, in metres from the world's origin; null: nothing looks up.
export function floorHeight_m(samples: SurfaceSamples, up: Direction): number | null {
  const layers = new Map<number, number>();
  let total = 0;
  for (let i = 0; i < samples.count; ++i) {
    if (dotAt(samples.normals, i, up) < 0.95) continue;
    const layer = Math.round(dotAt(samples.positions_m, i, up) / layer_m);
    layers.set(layer, (layers.get(layer) ?? 0) + samples.weights[i]!);
    total += samples.weights[i]!;
  }
  const thick = (layer: number): number =>
    (layers.get(layer - 1) ?? 0) + (layers.get(layer) ?? 0) + (layers.get(layer + 1) ?? 0);
  const floors = [...layers.keys()]
    .filter((layer) => thick(layer) >= floorShare * total)
    .sort((a, b) => a - b);
  if (floors.length === 0) return null;
  // Of the lowest one the middle: the fullest of the layers next to it.
  const lowest = floors[0]!;
  const middle = [lowest, lowest + 1, lowest + 2].reduce((best, layer) =>
    (layers.get(layer) ?? 0) > (layers.get(best) ?? 0) ? layer : best,
  );
  return middle * layer_m;
}

interface Bin {
  readonly direction: Direction;
  readonly share: number; // of all weights
}

interface Support {
  readonly floor: number; // shares of the surface: facing it,
  readonly ceiling: number; // facing away,
  readonly walls: number; // and along it
}

function support(bins: readonly Bin[], up: Direction, within_rad: number): Support {
  const [across, along] = [Math.cos(within_rad), Math.sin(within_rad)];
  let [floor, ceiling, walls] = [0, 0, 0];
  for (const { direction, share } of bins) {
    const cosine = dot(direction, up);
    if (cosine > across) floor += share;
    else if (cosine < -across) ceiling += share;
    else if (Math.abs(cosine) < along) walls += share;
  }
  return { floor, ceiling, walls };
}

// The mean directions of those that are not empty.
function binned(samples: SurfaceSamples): Bin[] {
  const sums = new Map<number, [number, number, number, number]>();
  let total = 0;
  for (let i = 0; i < samples.count; ++i) {
    const weight = samples.weights[i]!;
    const [x, y, z] = [
      samples.normals[3 * i]!,
      samples.normals[3 * i + 1]!,
      samples.normals[3 * i + 2]!,
    ];
    const bin = binOf(x, y, z);
    const sum = sums.get(bin) ?? [0, 0, 0, 0];
    sum[0] += weight * x;
    sum[1] += weight * y;
    sum[2] += weight * z;
    sum[3] += weight;
    sums.set(bin, sum);
    total += weight;
  }
  return [...sums.values()].map(([x, y, z, weight]) => ({
    direction: unit([x, y, z]),
    share: weight / total,
  }));
}

function binOf(x: number, y: number, z: number): number {
  const [ax, ay, az] = [Math.abs(x), Math.abs(y), Math.abs(z)];
  const longest = Math.max(ax, ay, az);
  const cell = (value: number): number =>
    Math.min(binsPerEdge - 1, Math.floor(((value / longest) * 0.5 + 0.5) * binsPerEdge));
  const [face, u, v] =
    longest === ax
      ? [x > 0 ? 0 : 1, y, z]
      : longest === ay
        ? [y > 0 ? 2 : 3, x, z]
        : [z > 0 ? 4 : 5, x, y];
  return (face * binsPerEdge + cell(u)) * binsPerEdge + cell(v);
}

// `first` and the middles of all bins: also what nothing faces, since walls alone say it, too.
function candidates(first: Direction): Direction[] {
  const all: Direction[] = [first];
  const middle = (cell: number): number => ((cell + 0.5) / binsPerEdge) * 2 - 1;
  for (let i = 0; i < binsPerEdge; ++i)
    for (let j = 0; j < binsPerEdge; ++j) {
      const [u, v] = [middle(i), middle(j)];
      for (const direction of [
        [u, -1, v],
        [u, 1, v],
        [1, u, v],
        [-1, u, v],
        [u, v, 1],
        [u, v, -1],
      ] as const)
        all.push(unit(direction));
    }
  return all;
}

// The direction that floors and ceilings around it face best and walls lie along best: of
// M = sum w n nT over the walls less that over the others the eigenvector of the smallest
// eigenvalue, which powers of (trace - M) grow towards.
function refined(samples: SurfaceSamples, up: Direction, within_rad: number): Direction {
  const [across, along] = [Math.cos(within_rad), Math.sin(within_rad)];
  const m = [0, 0, 0, 0, 0, 0]; // xx xy xz yy yz zz
  let total = 0;
  for (let i = 0; i < samples.count; ++i) {
    const cosine = dotAt(samples.normals, i, up);
    const sign = Math.abs(cosine) > across ? -1 : Math.abs(cosine) < along ? 1 : 0;
    if (sign === 0) continue;
    const weight = sign * samples.weights[i]!;
    const [x, y, z] = [
      samples.normals[3 * i]!,
      samples.normals[3 * i + 1]!,
      samples.normals[3 * i + 2]!,
    ];
    [x * x, x * y, x * z, y * y, y * z, z * z].forEach((product, k) => (m[k]! += weight * product));
    total += samples.weights[i]!;
  }
  if (total === 0) return up;
  let direction = up;
  for (let step = 0; step < 60; ++step) {
    const [x, y, z] = direction;
    direction = unit([
      total * x - (m[0]! * x + m[1]! * y + m[2]! * z),
      total * y - (m[1]! * x + m[3]! * y + m[4]! * z),
      total * z - (m[2]! * x + m[4]! * y + m[5]! * z),
    ]);
  }
  return direction;
}

function dot(a: Direction, b: Direction): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function dotAt(values: Float32Array, i: number, direction: Direction): number {
  return (
    values[3 * i]! * direction[0] +
    values[3 * i + 1]! * direction[1] +
    values[3 * i + 2]! * direction[2]
  );
}

function unit([x, y, z]: Direction): Direction {
  const length = Math.hypot(x, y, z);
  return length > 0 ? [x / length, y / length, z / length] : firstCamerasUp;
}
