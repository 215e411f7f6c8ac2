// Measured distances: lines with words at their middles, in front of everything, and the point that was chosen first.
import { BufferAttribute, BufferGeometry, Group, Points, PointsMaterial } from 'three';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js';
import type { Measured, Place } from '../connection/measurements';
import { Label } from './label';
import type { Layer, ViewSize } from './layer';

const color = 0xe8590c; // shows on a light ground and on a dark one
const width_px = 3;
const end_px = 10;

type Words = Pick<Label, 'object' | 'say' | 'resize' | 'dispose'>;

export class MeasureLayer implements Layer {
  readonly object = new Group();
  private readonly lines = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({ color, linewidth: width_px, depthTest: false, transparent: true }));
  private readonly ends = new Points(new BufferGeometry(), new PointsMaterial({ color, size: end_px, sizeAttenuation: false, depthTest: false, transparent: true }));
  private labels: Words[] = [];
  private size: ViewSize | null = null;

  constructor(private readonly makeLabel: () => Words = () => new Label('#ffffff')) {
    this.lines.renderOrder = this.ends.renderOrder = 9;
    this.lines.frustumCulled = this.ends.frustumCulled = false;
    this.object.add(this.lines, this.ends);
    this.show([], null);
  }

  // `first`: a point that has no second yet.
  show(measured: readonly Measured[], first: Place | null): void {
    const places = [...measured.flatMap(({ from, to }) => [...from, ...to]), ...(first ?? [])];
    this.ends.geometry.dispose();
    this.ends.geometry = new BufferGeometry();
    this.ends.geometry.setAttribute('position', new BufferAttribute(Float32Array.from(places), 3));
    this.ends.visible = places.length > 0;
    this.lines.geometry.dispose();
    this.lines.geometry = new LineSegmentsGeometry();
    this.lines.visible = measured.length > 0;
    if (measured.length > 0) this.lines.geometry.setPositions(places.slice(0, 6 * measured.length));
    this.write(measured);
  }

  onResize(size: ViewSize): void {
    this.size = size;
    for (const label of this.labels) label.resize(size);
  }

  dispose(): void {
    this.write([]);
    this.lines.geometry.dispose();
    this.lines.material.dispose();
    this.ends.geometry.dispose();
    this.ends.material.dispose();
  }

  private write(measured: readonly Measured[]): void {
    for (const label of this.labels) {
      this.object.remove(label.object);
      label.dispose();
    }
    this.labels = measured.map(({ from, to, words }) => {
      const label = this.makeLabel();
      label.object.position.set((from[0] + to[0]) / 2, (from[1] + to[1]) / 2, (from[2] + to[2]) / 2);
      label.say(words);
      if (this.size) label.resize(this.size);
      this.object.add(label.object);
      return label;
    });
  }
}
