// Pieces of a surface in one buffer, drawn in one call from either side.
import { BufferAttribute, BufferGeometry, Mesh, type Material, type Vector3 } from 'three';
import type { MeshPiece } from '../connection/events';
import { RangeAllocator } from './range_allocator';

// A piece that grows by a few corners stays where it is. A multiple of 3, or triangles would begin
// within those of the piece before.
const grain = 48;
const cornersPerVertex = 6; // of a closed surface of triangles

interface Range {
  readonly start: number;
  readonly reserved: number;
}

export interface PieceRange {
  readonly vertices: Range;
  readonly vertexCount: number;
  readonly corners: Range; // of triangles
  readonly cornerCount: number;
}

export class MeshBatch {
  readonly front: Mesh<BufferGeometry, Material>;
  readonly back: Mesh<BufferGeometry, Material>;
  private readonly vertices: RangeAllocator;
  private readonly corners: RangeAllocator;
  private readonly positions: BufferAttribute;
  private readonly normals: BufferAttribute;
  private readonly colors: BufferAttribute;
  private readonly rows: BufferAttribute;
  private readonly index: BufferAttribute;

  // `least`: the piece that must have room.
  constructor(
    capacity: number,
    least: MeshPiece,
    materials: { readonly front: Material; readonly back: Material },
  ) {
    const vertexCapacity = Math.max(capacity, least.positions_m.length / 3);
    const cornerCapacity = Math.max(cornersPerVertex * vertexCapacity, least.index.length);
    this.vertices = new RangeAllocator(vertexCapacity);
    this.corners = new RangeAllocator(cornerCapacity);
    this.positions = new BufferAttribute(new Float32Array(vertexCapacity * 3), 3);
    this.normals = new BufferAttribute(new Int8Array(vertexCapacity * 4), 4, true);
    this.colors = new BufferAttribute(new Uint8Array(vertexCapacity * 4), 4, true);
    this.rows = new BufferAttribute(new Float32Array(vertexCapacity), 1);
    this.index = new BufferAttribute(new Uint32Array(cornerCapacity), 1);
    const geometry = new BufferGeometry();
    for (const [name, attribute] of Object.entries({
      position: this.positions,
      normal: this.normals,
      color: this.colors,
      row: this.rows,
    }))
      geometry.setAttribute(name, attribute);
    geometry.setIndex(this.index);
    this.front = new Mesh(geometry, materials.front);
    this.back = new Mesh(geometry, materials.back);
    this.back.renderOrder = 1;
    for (const side of [this.front, this.back]) {
      side.frustumCulled = false; // its pieces are anywhere
      side.matrixAutoUpdate = false;
    }
  }

  get isEmpty(): boolean {
    return this.vertices.end === 0;
  }

  // `row`: of the submap that it moves with (PoseTexture). Null: no room.
  put(piece: MeshPiece, row: number): PieceRange | null {
    const [vertexCount, cornerCount] = [piece.positions_m.length / 3, piece.index.length];
    const vertices = takenFrom(this.vertices, vertexCount);
    if (!vertices) return null;
    const corners = takenFrom(this.corners, cornerCount);
    if (!corners) {
      this.vertices.give(vertices.start, vertices.reserved);
      return null;
    }
    this.positions.array.set(piece.positions_m, vertices.start * 3);
    this.normals.array.set(piece.normals, vertices.start * 4);
    this.colors.array.set(piece.colors, vertices.start * 4);
    this.rows.array.fill(row, vertices.start, vertices.start + vertexCount);
    for (let i = 0; i < cornerCount; ++i)
      this.index.array[corners.start + i] = piece.index[i]! + vertices.start;
    this.index.array.fill(0, corners.start + cornerCount, corners.start + corners.reserved);
    for (const attribute of [this.positions, this.normals, this.colors, this.rows])
      renew(attribute, vertices);
    renew(this.index, corners);
    this.front.geometry.setDrawRange(0, this.corners.end);
    return { vertices, vertexCount, corners, cornerCount };
  }

  // Triangles with all corners in one place are not drawn.
  remove({ vertices, corners }: PieceRange): void {
    this.vertices.give(vertices.start, vertices.reserved);
    this.corners.give(corners.start, corners.reserved);
    this.index.array.fill(0, corners.start, corners.start + corners.reserved);
    renew(this.index, corners);
    this.front.geometry.setDrawRange(0, this.corners.end);
  }

  // In the frame of its submap.
  vertexAt(i: number): {
    readonly position_m: readonly [number, number, number];
    readonly normal: readonly [number, number, number];
  } {
    return {
      position_m: [this.positions.getX(i), this.positions.getY(i), this.positions.getZ(i)],
      normal: [this.normals.getX(i), this.normals.getY(i), this.normals.getZ(i)],
    };
  }

  // The same, without its normal.
  placeAt(i: number, into: Vector3): Vector3 {
    return into.fromArray(this.positions.array, 3 * i);
  }

  // The vertex at a corner.
  cornerAt(i: number): number {
    return this.index.getX(i);
  }

  // Adds vertices by their eighths of confidence, 256 of them.
  countConfidences({ vertices, vertexCount }: PieceRange, into: Uint32Array): void {
    for (let i = vertices.start; i < vertices.start + vertexCount; ++i)
      ++into[this.colors.array[4 * i + 3]!]!;
  }

  dispose(): void {
    this.front.geometry.dispose();
  }
}

function takenFrom(allocator: RangeAllocator, count: number): Range | null {
  const reserved = Math.min(allocator.capacity, Math.ceil(count / grain) * grain);
  const start = count > reserved ? null : allocator.take(reserved);
  return start === null ? null : { start, reserved };
}

function renew(attribute: BufferAttribute, { start, reserved }: Range): void {
  attribute.addUpdateRange(start * attribute.itemSize, reserved * attribute.itemSize);
  attribute.needsUpdate = true;
}
