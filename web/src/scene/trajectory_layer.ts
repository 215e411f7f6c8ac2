// The way of the camera through the world, as a line. Every position belongs to a submap: a
// correction bends the line with the points.
import {
  BufferAttribute,
  BufferGeometry,
  DynamicDrawUsage,
  Line,
  LineBasicMaterial,
  Vector3,
} from 'three';
import type { ScanEvent } from '../connection/events';
import type { Layer } from './layer';
import type { SubmapsLayer } from './submaps_layer';

const firstCapacity = 1024;
const positionLimit = 1_000_000; // nine hours at 30 Hz; the line then stays as it is
const inWorld = 0xffffffff; // instead of a submap: of a scan that is over, or from an older server

export class TrajectoryLayer implements Layer {
  readonly object: Line<BufferGeometry, LineBasicMaterial>;
  private inSubmaps_m = new Float32Array(firstCapacity * 3);
  private inWorld_m = new Float32Array(firstCapacity * 3);
  private ofSubmap = new Uint32Array(firstCapacity);
  private length = 0;
  private seenVersion = 0; // of the submaps' poses

  constructor(private readonly submaps: SubmapsLayer) {
    this.object = new Line(
      new BufferGeometry(),
      new LineBasicMaterial({ color: 0x7fd1b9, transparent: true, opacity: 0.75 }),
    );
    this.object.frustumCulled = false;
    this.show();
  }

  onEvent(event: ScanEvent): void {
    if (event.kind === 'welcome')
      this.length = 0; // the server sends the past again
    else if (event.kind === 'trajectory') this.replace(event.positions_m, event.submaps);
    else if (event.kind !== 'frame' || event.tracking === 'lost') return;
    else if (!event.inSubmap) this.append(event.worldFromCamera.translation, null);
    else this.append(event.inSubmap.submapFromCamera.translation, [event.inSubmap.submap]);
    this.object.geometry.setDrawRange(0, this.length);
  }

  // After that of the submaps.
  tick(): boolean {
    if (this.seenVersion === this.submaps.version) return false;
    this.seenVersion = this.submaps.version;
    this.place(0);
    return false;
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }

  // All so far: of a viewer that has just come, or when the map was made anew.
  private replace(positions_m: ArrayLike<number>, submaps: ArrayLike<number> | null): void {
    this.length = 0;
    this.append(positions_m, submaps);
  }

  private append(positions_m: ArrayLike<number>, submaps: ArrayLike<number> | null): void {
    const added = Math.min(positions_m.length / 3, positionLimit - this.length);
    if (added <= 0) return;
    if (this.length + added > this.ofSubmap.length) this.grow(this.length + added);
    for (let i = 0; i < added * 3; ++i) this.inSubmaps_m[this.length * 3 + i] = positions_m[i]!;
    for (let i = 0; i < added; ++i)
      this.ofSubmap[this.length + i] = submaps ? submaps[i]! : inWorld;
    this.length += added;
    this.place(this.length - added);
  }

  // Into the world, from this position on.
  private place(first: number): void {
    const position_m = new Vector3();
    for (let i = first; i < this.length; ++i) {
      const submap = this.ofSubmap[i]!;
      position_m.fromArray(this.inSubmaps_m, 3 * i);
      if (submap !== inWorld) position_m.applyMatrix4(this.submaps.groupOf(submap).matrix);
      position_m.toArray(this.inWorld_m, 3 * i);
    }
    const attribute = this.object.geometry.getAttribute('position') as BufferAttribute;
    attribute.addUpdateRange(first * 3, (this.length - first) * 3);
    attribute.needsUpdate = true;
  }

  private grow(needed: number): void {
    const capacity = Math.max(needed, 2 * this.ofSubmap.length);
    const larger = <Numbers extends Float32Array | Uint32Array>(
      into: Numbers,
      from: Numbers,
    ): Numbers => {
      into.set(from);
      return into;
    };
    this.inSubmaps_m = larger(new Float32Array(3 * capacity), this.inSubmaps_m);
    this.inWorld_m = larger(new Float32Array(3 * capacity), this.inWorld_m);
    this.ofSubmap = larger(new Uint32Array(capacity), this.ofSubmap);
    this.show();
  }

  private show(): void {
    this.object.geometry.dispose();
    const attribute = new BufferAttribute(this.inWorld_m, 3);
    attribute.setUsage(DynamicDrawUsage);
    this.object.geometry = new BufferGeometry();
    this.object.geometry.setAttribute('position', attribute);
    this.object.geometry.setDrawRange(0, this.length);
  }
}
