// The points of a comparison (core/compare/compare_output.h) -> chunks to be shown. The bytes come
// from our own server, but what they declare is checked before anything is read by it.
import type { ChunkPoints } from './events';
import { radiiOf } from './spacing';

export class PointsError extends Error {}

// As the server's PointState.
export const pointStates = ['unseen', 'same', 'moved', 'removed', 'added'] as const;
export type PointStateName = (typeof pointStates)[number];

// Points of one scan in a cube, in the first scan's world.
export interface ComparedChunk {
  readonly scan: 0 | 1;
  readonly cube: readonly [number, number, number];
  readonly points: ChunkPoints; // in their own colours
  readonly states: Uint8Array; // indices of pointStates
  readonly distances_m: Float32Array; // NaN: the other scan has no surface there
}

// Where a region lies as its points say, and where it looks.
export interface RegionPlace {
  readonly middle_m: readonly [number, number, number];
  // The mean of its points, of unit length; 0 if they cancel out.
  readonly normal: readonly [number, number, number];
}

export interface ComparedPoints {
  readonly chunks: readonly ComparedChunk[];
  readonly regions: ReadonlyMap<number, RegionPlace>; // by index in the report
}

const cube_m = 0.64;
const mostPoints = 2_000_000;
const mostHeader_bytes = 4_096;

interface Column {
  readonly offset: number;
  readonly type: string;
}

const sizes: Readonly<Record<string, number>> = {
  char: 1,
  uchar: 1,
  short: 2,
  ushort: 2,
  int: 4,
  uint: 4,
  float: 4,
  double: 8,
};
const wanted: Readonly<Record<string, string>> = {
  ...Object.fromEntries(
    ['x', 'y', 'z', 'nx', 'ny', 'nz', 'distance', 'sigma'].map((name) => [name, 'float']),
  ),
  ...Object.fromEntries(['red', 'green', 'blue', 'state', 'scan'].map((name) => [name, 'uchar'])),
  region: 'int',
};

interface Header {
  readonly count: number;
  readonly stride: number;
  readonly begin: number; // of the points, in bytes
  readonly columns: ReadonlyMap<string, Column>;
}

export function readComparedPoints(buffer: ArrayBuffer): ComparedPoints {
  const header = headerOf(buffer);
  const at = readerOf(buffer, header);
  const members = new Map<string, number[]>();
  const regions = new Map<number, { count: number; sum: number[]; normal: number[] }>();
  for (let i = 0; i < header.count; ++i) {
    const position = [at.x(i), at.y(i), at.z(i)];
    if (!position.every(Number.isFinite)) throw new PointsError('a position is not finite');
    const name = [
      at.scan(i) === 0 ? 0 : 1,
      ...position.map((value) => Math.floor(value / cube_m)),
    ].join(' ');
    const list = members.get(name);
    if (list) list.push(i);
    else members.set(name, [i]);
    const region = at.region(i);
    if (region < 0) continue;
    const known = regions.get(region) ?? { count: 0, sum: [0, 0, 0], normal: [0, 0, 0] };
    regions.set(region, known);
    ++known.count;
    [at.nx(i), at.ny(i), at.nz(i)].forEach((value, axis) => {
      known.normal[axis]! += value;
      known.sum[axis]! += position[axis]!;
    });
  }
  return {
    chunks: [...members].map(([name, list]) => chunkOf(name, list, at)),
    regions: new Map(
      [...regions].map(([region, { count, sum, normal }]) => [
        region,
        { middle_m: scaled(sum, 1 / count), normal: unit(normal) },
      ]),
    ),
  };
}

function headerOf(buffer: ArrayBuffer): Header {
  const text = new TextDecoder('latin1').decode(buffer.slice(0, mostHeader_bytes));
  const end = text.indexOf('end_header\n');
  if (!text.startsWith('ply\nformat binary_little_endian 1.0\n') || end < 0)
    throw new PointsError('these are not the points of a comparison');
  const begin = end + 'end_header\n'.length;
  let count = -1;
  let stride = 0;
  const columns = new Map<string, Column>();
  for (const line of text.slice(0, end).split('\n')) {
    const [word, first = '', second = ''] = line.split(' ');
    if (word === 'element')
      count = first === 'vertex' && /^\d{1,9}$/.test(second) ? Number(second) : -1;
    if (word !== 'property') continue;
    columns.set(second, { offset: stride, type: first });
    stride += sizes[first] ?? NaN;
  }
  for (const [name, type] of Object.entries(wanted))
    if (columns.get(name)?.type !== type)
      throw new PointsError(`the points have no column ${name}`);
  if (count < 0 || count > mostPoints)
    throw new PointsError(`${count} points, allowed are up to ${mostPoints}`);
  if (buffer.byteLength !== begin + count * stride)
    throw new PointsError(`${count} points do not fit into ${buffer.byteLength} bytes`);
  return { count, stride, begin, columns };
}

type Reader = Readonly<Record<string, (i: number) => number>> &
  Readonly<
    Record<
      | 'x'
      | 'y'
      | 'z'
      | 'nx'
      | 'ny'
      | 'nz'
      | 'red'
      | 'green'
      | 'blue'
      | 'distance'
      | 'state'
      | 'scan'
      | 'region',
      (i: number) => number
    >
  >;

function readerOf(buffer: ArrayBuffer, { stride, begin, columns }: Header): Reader {
  const view = new DataView(buffer);
  const read = ({ offset, type }: Column): ((i: number) => number) => {
    if (type === 'float') return (i) => view.getFloat32(begin + i * stride + offset, true);
    if (type === 'int') return (i) => view.getInt32(begin + i * stride + offset, true);
    return (i) => view.getUint8(begin + i * stride + offset);
  };
  return Object.fromEntries(
    Object.keys(wanted).map((name) => [name, read(columns.get(name)!)]),
  ) as Reader;
}

function chunkOf(name: string, members: readonly number[], at: Reader): ComparedChunk {
  const [scan, x, y, z] = name.split(' ').map(Number) as [number, number, number, number];
  const count = members.length;
  const positions_m = new Float32Array(3 * count);
  const [colors, normals] = [new Uint8Array(4 * count), new Int8Array(4 * count)];
  const [states, distances_m] = [new Uint8Array(count), new Float32Array(count)];
  const [min_m, max_m]: [[number, number, number], [number, number, number]] = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ];
  members.forEach((i, to) => {
    positions_m.set([at.x(i), at.y(i), at.z(i)], 3 * to);
    colors.set([at.red(i), at.green(i), at.blue(i), 255], 4 * to);
    normals.set(
      [at.nx(i), at.ny(i), at.nz(i)].map((value) => Math.round(127 * value)),
      4 * to,
    );
    states[to] = Math.min(at.state(i), pointStates.length - 1);
    distances_m[to] = at.distance(i);
    for (const axis of [0, 1, 2] as const) {
      const value = positions_m[3 * to + axis]!;
      min_m[axis] = Math.min(min_m[axis], value);
      max_m[axis] = Math.max(max_m[axis], value);
    }
  });
  const radii_m = radiiOf(positions_m, normals, 0);
  return {
    scan: scan === 0 ? 0 : 1,
    cube: [x, y, z],
    points: { count, positions_m, colors, normals, radii_m, min_m, max_m },
    states,
    distances_m,
  };
}

function scaled(vector: readonly number[], by: number): [number, number, number] {
  return [vector[0]! * by, vector[1]! * by, vector[2]! * by];
}

function unit(vector: readonly number[]): [number, number, number] {
  const length = Math.hypot(...vector);
  return scaled(vector, length > 1e-6 ? 1 / length : 0);
}
