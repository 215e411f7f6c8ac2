// The way of the camera through the world, as a line.
import { BufferAttribute, BufferGeometry, DynamicDrawUsage, Line, LineBasicMaterial } from 'three';
import type { ScanEvent } from '../connection/events';
import type { Layer } from './layer';

const firstCapacity = 1024;
const positionLimit = 1_000_000; // nine hours at 30 Hz; the line then stays as it is

export class TrajectoryLayer implements Layer {
  readonly object: Line<BufferGeometry, LineBasicMaterial>;
  private positions_m = new Float32Array(firstCapacity * 3);
  private length = 0;

  constructor() {
    this.object = new Line(new BufferGeometry(), new LineBasicMaterial({ color: 0x7fd1b9, transparent: true, opacity: 0.75 }));
    this.object.frustumCulled = false;
    this.show();
  }

  onEvent(event: ScanEvent): void {
    if (event.kind === 'welcome') this.length = 0; // the server sends the past again
    else if (event.kind === 'trajectory') this.append(event.positions_m);
    else if (event.kind === 'frame' && event.tracking !== 'lost') this.append(event.worldFromCamera.translation);
    else return;
    this.object.geometry.setDrawRange(0, this.length);
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }

  private append(positions_m: ArrayLike<number>): void {
    const added = Math.min(positions_m.length / 3, positionLimit - this.length);
    if (added <= 0) return;
    if ((this.length + added) * 3 > this.positions_m.length) this.grow(this.length + added);
    for (let i = 0; i < added * 3; ++i) this.positions_m[this.length * 3 + i] = positions_m[i]!;
    const attribute = this.object.geometry.getAttribute('position') as BufferAttribute;
    attribute.addUpdateRange(this.length * 3, added * 3);
    attribute.needsUpdate = true;
    this.length += added;
  }

  private grow(needed: number): void {
    const larger = new Float32Array(Math.max(needed, this.positions_m.length / 1.5) * 3);
    larger.set(this.positions_m);
    this.positions_m = larger;
    this.show();
  }

  private show(): void {
    this.object.geometry.dispose();
    const attribute = new BufferAttribute(this.positions_m, 3);
    attribute.setUsage(DynamicDrawUsage);
    this.object.geometry = new BufferGeometry();
    this.object.geometry.setAttribute('position', attribute);
    this.object.geometry.setDrawRange(0, this.length);
  }
}
