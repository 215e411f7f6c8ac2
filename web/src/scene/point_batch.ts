// Points of many chunks in one buffer, drawn in one call.
import { BufferAttribute, BufferGeometry, Points, type Material } from 'three';
import type { ChunkPoints } from '../connection/events';
import { RangeAllocator } from './range_allocator';

const grain = 16; // a chunk that grows by a few points stays where it is

export interface BatchRange {
  readonly start: number;
  readonly count: number; // of points
  readonly reserved: number;
}

export class PointBatch {
  readonly object: Points<BufferGeometry, Material>;
  private readonly allocator: RangeAllocator;
  private readonly positions: BufferAttribute;
  private readonly radii: BufferAttribute;
  private readonly colors: BufferAttribute;
  private readonly normals: BufferAttribute;
  private readonly rows: BufferAttribute;

  constructor(capacity: number, material: Material) {
    this.allocator = new RangeAllocator(capacity);
    this.positions = new BufferAttribute(new Float32Array(capacity * 3), 3);
    this.radii = new BufferAttribute(new Float32Array(capacity), 1);
    this.colors = new BufferAttribute(new Uint8Array(capacity * 4), 4, true);
    this.normals = new BufferAttribute(new Int8Array(capacity * 4), 4, true);
    this.rows = new BufferAttribute(new Float32Array(capacity), 1);
    const geometry = new BufferGeometry();
    for (const [name, attribute] of Object.entries({
      position: this.positions,
      radius: this.radii,
      pointColor: this.colors,
      normal: this.normals,
      row: this.rows,
    }))
      geometry.setAttribute(name, attribute);
    this.object = new Points(geometry, material);
    this.object.frustumCulled = false; // its points are anywhere
    this.object.matrixAutoUpdate = false;
  }

  get isEmpty(): boolean {
    return this.allocator.end === 0;
  }

  // `row`: of the points' submap (PoseTexture). Null: no room.
  put(points: ChunkPoints, row: number): BatchRange | null {
    const reserved = Math.min(this.allocator.capacity, Math.ceil(points.count / grain) * grain);
    const start = this.allocator.take(reserved);
    if (start === null) return null;
    this.positions.array.set(points.positions_m, start * 3);
    this.radii.array.set(points.radii_m, start);
    this.colors.array.set(points.colors, start * 4);
    this.normals.array.set(points.normals, start * 4);
    this.rows.array.fill(row, start, start + points.count);
    this.radii.array.fill(0, start + points.count, start + reserved);
    for (const attribute of [this.positions, this.radii, this.colors, this.normals, this.rows])
      renew(attribute, start, reserved);
    this.object.geometry.setDrawRange(0, this.allocator.end);
    return { start, count: points.count, reserved };
  }

  // Points without a size are not drawn.
  remove({ start, reserved }: BatchRange): void {
    this.allocator.give(start, reserved);
    this.radii.array.fill(0, start, start + reserved);
    renew(this.radii, start, reserved);
    this.object.geometry.setDrawRange(0, this.allocator.end);
  }

  // In the frame of its submap.
  at(i: number): {
    readonly position_m: readonly [number, number, number];
    readonly normal: readonly [number, number, number];
    readonly radius_m: number;
  } {
    return {
      position_m: [this.positions.getX(i), this.positions.getY(i), this.positions.getZ(i)],
      normal: [this.normals.getX(i), this.normals.getY(i), this.normals.getZ(i)],
      radius_m: this.radii.getX(i),
    };
  }

  // Adds points by their eighths of confidence, 256 of them.
  countConfidences({ start, count }: BatchRange, into: Uint32Array): void {
    for (let i = start; i < start + count; ++i) ++into[this.colors.array[4 * i + 3]!]!;
  }

  dispose(): void {
    this.object.geometry.dispose();
  }
}

function renew(attribute: BufferAttribute, start: number, count: number): void {
  attribute.addUpdateRange(start * attribute.itemSize, count * attribute.itemSize);
  attribute.needsUpdate = true;
}
