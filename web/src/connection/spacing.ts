// How large a disc each point of a chunk needs so that no gap stays between it and its neighbours: the server sends no radii, and a far surface was seen by
// fewer rays than a near one. From the distance to the neighbours that lie around a point, found in a grid of cells.

const neighbours = 6; // on a square grid the 6th lies at the diagonal
const overlap = 0.8; // of that distance: on a square grid a disc then reaches 1.6 times as far as it must
const cell_m = 0.0125; // of a chunk of level 0
const voxel_m = 0.005; // the server keeps one point of each
const medianLimit = 2; // at the edge of a chunk a point has neighbours on one side only
const cellsPerAxis = 4096; // more would be no chunk
const lookedAt = 100; // of the points of a cell: in a voxel there is one, and no server makes a page count for ever

// Metres, one a point. `level`: of the chunk, whose lengths are 2^level times as long.
export function radiiOf(positions_m: Float32Array, level: number): Float32Array {
  const count = positions_m.length / 3;
  const scale = 2 ** level;
  const [least_m, cellEdge_m] = [0.5 * voxel_m * scale, cell_m * scale];
  const most_m = 2 * cellEdge_m;
  const cells = new Map<number, number[]>();
  const cellOf = (i: number, axis: number): number => (Math.floor(positions_m[3 * i + axis]! / cellEdge_m) % cellsPerAxis) + cellsPerAxis;
  const nameOf = (x: number, y: number, z: number): number => (x * 3 * cellsPerAxis + y) * 3 * cellsPerAxis + z;
  for (let i = 0; i < count; ++i) {
    const name = nameOf(cellOf(i, 0), cellOf(i, 1), cellOf(i, 2));
    const members = cells.get(name);
    if (members) members.push(i);
    else cells.set(name, [i]);
  }
  const radii_m = new Float32Array(count);
  const nearest = new Float64Array(neighbours);
  for (const members of cells.values()) {
    const [x, y, z] = [cellOf(members[0]!, 0), cellOf(members[0]!, 1), cellOf(members[0]!, 2)];
    const around: number[][] = [];
    for (let dx = -1; dx <= 1; ++dx)
      for (let dy = -1; dy <= 1; ++dy)
        for (let dz = -1; dz <= 1; ++dz) {
          const there = cells.get(nameOf(x + dx, y + dy, z + dz));
          if (there) around.push(there);
        }
    for (const i of members) {
      nearest.fill(Infinity);
      for (const there of around)
        for (let k = 0; k < Math.min(there.length, lookedAt); ++k) if (there[k] !== i) insert(nearest, squared(positions_m, i, there[k]!));
      let last = neighbours - 1;
      while (last > 0 && nearest[last] === Infinity) --last;
      const reach_m = Math.min(most_m, Math.sqrt(nearest[last]!));
      radii_m[i] = Math.min(most_m, Math.max(least_m, overlap * reach_m));
    }
  }
  const limit_m = medianLimit * median(radii_m);
  for (let i = 0; i < count; ++i) radii_m[i] = Math.min(radii_m[i]!, limit_m);
  return radii_m;
}

function squared(positions_m: Float32Array, i: number, j: number): number {
  const x = positions_m[3 * i]! - positions_m[3 * j]!;
  const y = positions_m[3 * i + 1]! - positions_m[3 * j + 1]!;
  const z = positions_m[3 * i + 2]! - positions_m[3 * j + 2]!;
  return x * x + y * y + z * z;
}

// Into a short list in order.
function insert(nearest: Float64Array, value: number): void {
  if (value >= nearest[nearest.length - 1]!) return;
  let at = nearest.length - 1;
  for (; at > 0 && nearest[at - 1]! > value; --at) nearest[at] = nearest[at - 1]!;
  nearest[at] = value;
}

function median(values: Float32Array): number {
  return Float32Array.from(values).sort()[Math.floor(values.length / 2)] ?? 0;
}
