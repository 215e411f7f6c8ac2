// How large a disc each point of a chunk needs so that no gap stays between it and its neighbours:
// the server sends no radii, and a far surface was seen by fewer rays than a near one, in rows that
// lie further apart than their points. Hence from the nearest neighbour on each of four sides of a
// point, found in a grid of cells.

// Of a chunk of level 0. The larger cells are for points that have nothing near on some side.
const cells_m = [0.0125, 0.03] as const;
const voxel_m = 0.005; // the server keeps one point of each
const reach = 0.8; // of the distance to the furthest of the four; on a square grid 0.71 would do
const offPlane = 0.5; // of its distance: what lies further above or below is another surface
const medianLimit = 3; // what comes behind a wide gap is another surface
const cellsPerAxis = 4096; // more would be no chunk
// Of the points of a cell so many are looked at: a voxel has one, and no server
// makes a page count for ever.
const lookedAt = 100;

// Metres, one a point. `normals`: as in ChunkPoints. `level`: of the chunk, whose lengths
// are 2^level times as long.
export function radiiOf(
  positions_m: Float32Array,
  normals: Int8Array,
  level: number,
): Float32Array {
  const count = positions_m.length / 3;
  const scale = 2 ** level;
  const least_m = 0.5 * voxel_m * scale;
  const most_m = cells_m[1] * scale;
  const [near, far] = cells_m.map((cell_m) => new Grid(positions_m, cell_m * scale)) as [
    Grid,
    Grid,
  ];
  const radii_m = new Float32Array(count);
  const openSides: number[] = []; // points at an edge of the surface, or of the chunk
  for (const members of near.cells()) {
    const around = near.around(members[0]!);
    for (const i of members) {
      if (!look(positions_m, normals, i, around) && !look(positions_m, normals, i, far.around(i)))
        openSides.push(i);
      radii_m[i] = Math.min(most_m, Math.max(least_m, reach * furthestSide_m()));
    }
  }
  const usual_m = median(radii_m);
  // The next chunk may be as sparse.
  for (const i of openSides) radii_m[i] = Math.max(radii_m[i]!, usual_m);
  for (let i = 0; i < count; ++i) radii_m[i] = Math.min(radii_m[i]!, medianLimit * usual_m);
  return radii_m;
}

class Grid {
  private readonly members = new Map<number, number[]>();

  constructor(
    private readonly positions_m: Float32Array,
    private readonly edge_m: number,
  ) {
    for (let i = 0; i < positions_m.length / 3; ++i) {
      const name = nameOf(this.cellOf(i, 0), this.cellOf(i, 1), this.cellOf(i, 2));
      const members = this.members.get(name);
      if (members) members.push(i);
      else this.members.set(name, [i]);
    }
  }

  cells(): Iterable<readonly number[]> {
    return this.members.values();
  }

  // The cells next to that of a point, and its own.
  around(i: number): (readonly number[])[] {
    const [x, y, z] = [this.cellOf(i, 0), this.cellOf(i, 1), this.cellOf(i, 2)];
    const found: (readonly number[])[] = [];
    for (let dx = -1; dx <= 1; ++dx)
      for (let dy = -1; dy <= 1; ++dy)
        for (let dz = -1; dz <= 1; ++dz) {
          const there = this.members.get(nameOf(x + dx, y + dy, z + dz));
          if (there) found.push(there);
        }
    return found;
  }

  private cellOf(i: number, axis: number): number {
    return (
      (Math.floor(this.positions_m[3 * i + axis]! / this.edge_m) % cellsPerAxis) + cellsPerAxis
    );
  }
}

function nameOf(x: number, y: number, z: number): number {
  return (x * 3 * cellsPerAxis + y) * 3 * cellsPerAxis + z;
}

const sides = new Float64Array(4); // squared distance to the nearest neighbour on each

// Infinity: nobody is near.
function furthestSide_m(): number {
  let furthest = 0;
  for (const squared of sides) if (squared < Infinity && squared > furthest) furthest = squared;
  return furthest === 0 && sides.every((squared) => squared === Infinity)
    ? Infinity
    : Math.sqrt(furthest);
}

// Fills `sides`; whether there is somebody on each.
function look(
  positions_m: Float32Array,
  normals: Int8Array,
  i: number,
  around: readonly (readonly number[])[],
): boolean {
  const [px, py, pz] = [positions_m[3 * i]!, positions_m[3 * i + 1]!, positions_m[3 * i + 2]!];
  const [nx, ny, nz] = [
    normals[4 * i]! / 127,
    normals[4 * i + 1]! / 127,
    normals[4 * i + 2]! / 127,
  ];
  // Two directions along the surface. Where there is no normal they are oblique to all axes, so
  // that floors and walls have points on all four sides.
  const isKnown = nx !== 0 || ny !== 0 || nz !== 0;
  const [ux, uy, uz] = !isKnown ? [1, 0.5, 0.25] : Math.abs(nx) > 0.7 ? [-ny, nx, 0] : [0, nz, -ny];
  const [vx, vy, vz] = !isKnown
    ? [0.25, 1, -0.5]
    : [ny * uz - nz * uy, nz * ux - nx * uz, nx * uy - ny * ux];
  sides.fill(Infinity);
  for (const there of around) {
    const end = Math.min(there.length, lookedAt);
    for (let k = 0; k < end; ++k) {
      const j = there[k]!;
      if (j === i) continue;
      const x = positions_m[3 * j]! - px;
      const y = positions_m[3 * j + 1]! - py;
      const z = positions_m[3 * j + 2]! - pz;
      const squared = x * x + y * y + z * z;
      const above = x * nx + y * ny + z * nz;
      if (above * above > offPlane * offPlane * squared) continue;
      const side =
        (x * ux + y * uy + z * uz >= 0 ? 1 : 0) + (x * vx + y * vy + z * vz >= 0 ? 2 : 0);
      if (squared < sides[side]!) sides[side] = squared;
    }
  }
  return sides.every((squared) => squared < Infinity);
}

function median(values: Float32Array): number {
  return Float32Array.from(values).sort()[Math.floor(values.length / 2)] ?? 0;
}
