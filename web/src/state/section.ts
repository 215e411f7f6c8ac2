// Where a surface of triangles meets a plane: line segments, and those joined to polylines. Pure.
//
// An edge in the plane is a line once, however many triangles have it. Of an area that lies in the
// plane the outline is drawn.
import { combined, dot, threeOf, type Axes, type Triple } from './axes';
import type { Box, Plane } from './cutting';

export interface Surface {
  readonly positions_m: ArrayLike<number>; // three a vertex, in the world of the scan
  readonly index: ArrayLike<number>; // three a triangle
}

export type Point = readonly [number, number]; // in the plane: u, v

export interface Polyline {
  readonly points: readonly Point[]; // of a closed one the first is not said again
  readonly closed: boolean;
}

const weld_m = 1e-5; // ends as near are the same

// u and v of both ends, four numbers a segment.
export function segmentsOf(surface: Surface, plane: Plane): number[] {
  const heights = heightsOf(surface, plane);
  const lines = new LineSet();
  for (let i = 0; i + 2 < surface.index.length; i += 3)
    cutTriangle(surface, heights, plane, i, lines);
  return lines.take();
}

// Of the vertices above the plane.
function heightsOf({ positions_m }: Surface, { normal, at_m }: Plane): Float64Array {
  const heights = new Float64Array(Math.floor(positions_m.length / 3));
  for (let i = 0, k = 0; i < heights.length; ++i, k += 3)
    heights[i] =
      positions_m[k]! * normal[0] +
      positions_m[k + 1]! * normal[1] +
      positions_m[k + 2]! * normal[2] -
      at_m;
  return heights;
}

function cutTriangle(
  { positions_m, index }: Surface,
  heights: Float64Array,
  plane: Plane,
  first: number,
  lines: LineSet,
): void {
  const corners = [index[first]!, index[first + 1]!, index[first + 2]!] as const;
  const [a, b, c] = [heights[corners[0]]!, heights[corners[1]]!, heights[corners[2]]!];
  if ((a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0) || !Number.isFinite(a + b + c)) return;
  const at = (i: number): Triple => [
    positions_m[3 * i]!,
    positions_m[3 * i + 1]!,
    positions_m[3 * i + 2]!,
  ];
  const onPlane = corners.filter((i) => heights[i] === 0).map((i) => flat(at(i), plane));
  if (onPlane.length === 3) {
    if (areaOf(onPlane as [Point, Point, Point]) > 0)
      onPlane.forEach((point, k) => lines.addFlat(point, onPlane[(k + 1) % 3]!));
    return;
  }
  const ends = [...onPlane];
  for (let k = 0; k < 3; ++k) {
    const [i, j] = [corners[k]!, corners[(k + 1) % 3]!];
    if (heights[i]! * heights[j]! >= 0) continue;
    // Always from below: triangles on both sides of an edge find the same point, to the last bit.
    const [low, high] = heights[i]! < 0 ? [i, j] : [j, i];
    const share = heights[low]! / (heights[low]! - heights[high]!);
    ends.push(flat(combined(at(low), 1 - share, at(high), share), plane));
  }
  if (ends.length === 2) lines.add(ends[0]!, ends[1]!);
}

function flat(point: Triple, { u, v }: Plane): Point {
  return [dot(point, u), dot(point, v)];
}

function areaOf([a, b, c]: readonly [Point, Point, Point]): number {
  return Math.abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

// Gives ends that are nearly in one place the same number.
class Welder {
  readonly points: Point[] = [];
  private readonly cells = new Map<string, number[]>();

  numberOf(point: Point): number {
    const [x, y] = [Math.floor(point[0] / weld_m), Math.floor(point[1] / weld_m)];
    for (let i = x - 1; i <= x + 1; ++i)
      for (let j = y - 1; j <= y + 1; ++j)
        for (const number of this.cells.get(`${i},${j}`) ?? []) {
          const other = this.points[number]!;
          if (Math.hypot(other[0] - point[0], other[1] - point[1]) <= weld_m) return number;
        }
    const key = `${x},${y}`;
    const number = this.points.push(point) - 1;
    this.cells.set(key, [...(this.cells.get(key) ?? []), number]);
    return number;
  }
}

// Segments without those that have no length, each once.
class LineSet {
  private readonly welder = new Welder();
  private readonly lines = new Map<string, readonly [number, number]>();
  private readonly flat = new Map<
    string,
    { readonly ends: readonly [number, number]; times: number }
  >(); // sides of triangles in the plane

  add(from: Point, to: Point): void {
    const ends = this.endsOf(from, to);
    if (ends) this.lines.set(ends.join(), ends);
  }

  addFlat(from: Point, to: Point): void {
    const ends = this.endsOf(from, to);
    if (!ends) return;
    const side = this.flat.get(ends.join()) ?? { ends, times: 0 };
    ++side.times;
    this.flat.set(ends.join(), side);
  }

  take(): number[] {
    for (const { ends, times } of this.flat.values())
      if (times % 2 === 1) this.lines.set(ends.join(), ends);
    return [...this.lines.values()].flatMap(([a, b]) => [
      ...this.welder.points[a]!,
      ...this.welder.points[b]!,
    ]);
  }

  private endsOf(from: Point, to: Point): readonly [number, number] | null {
    const [a, b] = [this.welder.numberOf(from), this.welder.numberOf(to)];
    return a === b ? null : a < b ? [a, b] : [b, a];
  }
}

// What of the segments is inside of the box.
export function clippedTo(
  segments: readonly number[],
  plane: Plane,
  axes: Axes,
  box: Box,
): number[] {
  const limits = threeOf(axes).map((axis, k) => ({
    at: dot(axis, plane.normal) * plane.at_m,
    u: dot(axis, plane.u),
    v: dot(axis, plane.v),
    low: box.low_m[k]!,
    high: box.high_m[k]!,
  }));
  const kept: number[] = [];
  for (let i = 0; i < segments.length; i += 4) {
    const [u, v, toU, toV] = [segments[i]!, segments[i + 1]!, segments[i + 2]!, segments[i + 3]!];
    let [from, to] = [0, 1];
    for (const limit of limits) {
      const start = limit.at + limit.u * u + limit.v * v;
      const rise = limit.u * (toU - u) + limit.v * (toV - v);
      if (rise === 0 && (start < limit.low || start > limit.high)) to = -1;
      if (rise === 0) continue;
      const [enter, leave] = [(limit.low - start) / rise, (limit.high - start) / rise].sort(
        (a, b) => a - b,
      ) as [number, number];
      from = Math.max(from, enter);
      to = Math.min(to, leave);
    }
    if (from < to)
      kept.push(u + from * (toU - u), v + from * (toV - v), u + to * (toU - u), v + to * (toV - v));
  }
  return kept;
}

// Segments that meet end to end, two and two, become one line.
export function joined(segments: readonly number[]): Polyline[] {
  const welder = new Welder();
  const edges: { readonly ends: readonly [number, number]; used: boolean }[] = [];
  const at = new Map<number, number[]>(); // the edges of a point
  for (let i = 0; i < segments.length; i += 4) {
    const ends = [
      welder.numberOf([segments[i]!, segments[i + 1]!]),
      welder.numberOf([segments[i + 2]!, segments[i + 3]!]),
    ] as const;
    if (ends[0] === ends[1]) continue;
    for (const end of ends) at.set(end, [...(at.get(end) ?? []), edges.length]);
    edges.push({ ends, used: false });
  }
  const walk = (start: number, first: number): Polyline => {
    const numbers = [start];
    for (let edge: number | undefined = first; edge !== undefined; ) {
      const { ends } = edges[edge]!;
      edges[edge]!.used = true;
      const next: number = ends[0] === numbers[numbers.length - 1] ? ends[1] : ends[0];
      numbers.push(next);
      const around: number[] = at.get(next)!;
      edge = around.length === 2 ? around.find((one) => !edges[one]!.used) : undefined;
    }
    const closed = numbers.length > 3 && numbers[0] === numbers[numbers.length - 1];
    return {
      points: (closed ? numbers.slice(0, -1) : numbers).map((number) => welder.points[number]!),
      closed,
    };
  };
  const lines: Polyline[] = [];
  // First from where lines end or branch; what is left then are rings.
  for (const [point, around] of at)
    if (around.length !== 2)
      for (const edge of around) if (!edges[edge]!.used) lines.push(walk(point, edge));
  edges.forEach((edge, i) => !edge.used && lines.push(walk(edge.ends[0], i)));
  return lines;
}

export function lengthOf(lines: readonly Polyline[]): number {
  const along = (points: readonly Point[]): number =>
    points
      .slice(1)
      .reduce(
        (sum, point, i) => sum + Math.hypot(point[0] - points[i]![0], point[1] - points[i]![1]),
        0,
      );
  return lines.reduce(
    (sum, { points, closed }) => sum + along(closed ? [...points, points[0]!] : points),
    0,
  );
}

// Least u and v, then most.
export function extentOf(lines: readonly Polyline[]): readonly [number, number, number, number] {
  let [left, low, right, high] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const { points } of lines)
    for (const [u, v] of points)
      [left, low, right, high] = [
        Math.min(left, u),
        Math.min(low, v),
        Math.max(right, u),
        Math.max(high, v),
      ];
  return [left, low, right, high];
}

// In the world of the scan.
export function placeOf([u, v]: Point, plane: Plane): Triple {
  return combined(combined(plane.u, u, plane.v, v), 1, plane.normal, plane.at_m);
}
