// Which squares of the ground have surface above them, and which have floor.
import type { Triple } from './axes';
import type { Extent } from './model_figures';

export type Corners = readonly [Triple, Triple, Triple]; // of a triangle

export const planSquare_m = 0.1;
const most_squares = 1 << 24;
// Visits to squares and rows, which take less than a second; a room of a million
// triangles needs 10 million.
const most_visits = 1 << 26;
const hair = 1e-4; // of a square: positions have 24 bits
const floorWithin_m = 0.06;

const hasSurface = 1;
const hasFloor = 2;

export class GroundPlan {
  private readonly squares: Uint8Array;
  private visits = 0;

  private constructor(
    private readonly low_m: Triple,
    private readonly columns: number,
    private readonly rows: number,
    private readonly most: number,
  ) {
    this.squares = new Uint8Array(columns * rows);
  }

  // Null when it would have too many squares.
  static over({ low_m, high_m }: Extent, most = most_visits): GroundPlan | null {
    const [columns, rows] = [0, 2].map((k) =>
      Math.max(1, Math.ceil((high_m[k]! - low_m[k]!) / planSquare_m)),
    ) as [number, number];
    return columns * rows <= most_squares ? new GroundPlan(low_m, columns, rows, most) : null;
  }

  // Marks the squares that a triangle touches, its corners along, up and across; as floor where it
  // is so high. False: that is too much work in all.
  mark(corners: Corners, floor_m: number | null): boolean {
    const flat = corners.map(([x, , z]): readonly [number, number] => [
      (x - this.low_m[0]) / planSquare_m,
      (z - this.low_m[2]) / planSquare_m,
    ]);
    const depths = flat.map(([, y]) => y);
    const [first, last] = spanOf(Math.min(...depths), Math.max(...depths), this.rows);
    const height_m = floor_m === null ? null : heightsOf(corners);
    for (let row = first; row <= last; ++row) {
      const [from, to] = rowOf(flat, row);
      const [left, right] = spanOf(from, to, this.columns);
      this.visits += 1 + Math.max(0, right - left + 1);
      if (this.visits > this.most) return false;
      for (let column = left; column <= right; ++column) {
        const isFloor =
          height_m !== null &&
          Math.abs(
            height_m(
              this.low_m[0] + (column + 0.5) * planSquare_m,
              this.low_m[2] + (row + 0.5) * planSquare_m,
            ) - floor_m!,
          ) < floorWithin_m;
        this.squares[row * this.columns + column]! |= isFloor ? hasSurface | hasFloor : hasSurface;
      }
    }
    return true;
  }

  counts(): { readonly surface: number; readonly floor: number } {
    let [surface, floor] = [0, 0];
    for (const square of this.squares) {
      surface += square & hasSurface;
      floor += (square & hasFloor) >> 1;
    }
    return { surface, floor };
  }
}

// The squares that have some of a length in them, not only an end; of `count` squares.
function spanOf(from: number, to: number, count: number): readonly [number, number] {
  const begin = Math.floor(from + hair);
  // What stands on the far border belongs to the last square.
  const first = begin === count && from < count + hair ? count - 1 : begin;
  return [Math.max(0, first), Math.min(count - 1, Math.max(first, Math.ceil(to - hair) - 1))];
}

// From where to where a triangle reaches in a row of squares.
function rowOf(
  corners: readonly (readonly [number, number])[],
  row: number,
): readonly [number, number] {
  const [near, far] = [row - hair, row + 1 + hair];
  let [from, to] = [Infinity, -Infinity];
  for (let i = 0; i < 3; ++i) {
    const [[ax, ay], [bx, by]] = [corners[i]!, corners[(i + 1) % 3]!];
    if (Math.max(ay, by) < near || Math.min(ay, by) > far) continue;
    for (const y of [Math.max(near, Math.min(ay, by)), Math.min(far, Math.max(ay, by))]) {
      const x = ay === by ? ax : ax + ((y - ay) / (by - ay)) * (bx - ax);
      from = Math.min(from, x);
      to = Math.max(to, x);
    }
    if (ay === by) [from, to] = [Math.min(from, bx), Math.max(to, bx)];
  }
  return [from, to];
}

// How high the plane of a triangle is, within its corners.
function heightsOf([[ax, ay, az], [bx, by, bz], [cx, cy, cz]]: Corners): (
  x_m: number,
  z_m: number,
) => number {
  const twice = (bx - ax) * (cz - az) - (cx - ax) * (bz - az);
  const [low, high] = [Math.min(ay, by, cy), Math.max(ay, by, cy)];
  return (x_m, z_m) => {
    const [u, v] = [
      ((x_m - ax) * (cz - az) - (cx - ax) * (z_m - az)) / twice,
      ((bx - ax) * (z_m - az) - (x_m - ax) * (bz - az)) / twice,
    ];
    return Math.max(low, Math.min(high, ay + u * (by - ay) + v * (cy - ay)));
  };
}
