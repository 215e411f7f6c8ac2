// What was measured: lines, patches of planes and text, in front of everything, and the points
// that were chosen so far.
import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  Group,
  Mesh,
  MeshBasicMaterial,
  Points,
  PointsMaterial,
} from 'three';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js';
import type { Measured, Place } from '../connection/measurements';
import { Label } from './label';
import type { Layer, ViewSize } from './layer';
import { linesThrough, shapeOf } from './measure_shape';

const color = 0xe8590c; // shows on a light ground and on a dark one
const width_px = 3;
const end_px = 10;
const patchOpacity = 0.3;

type TextLabel = Pick<Label, 'object' | 'say' | 'resize' | 'dispose'>;

export class MeasureLayer implements Layer {
  readonly object = new Group();
  private readonly lines = new LineSegments2(
    new LineSegmentsGeometry(),
    new LineMaterial({ color, linewidth: width_px, depthTest: false, transparent: true }),
  );
  private readonly ends = new Points(
    new BufferGeometry(),
    new PointsMaterial({
      color,
      size: end_px,
      sizeAttenuation: false,
      depthTest: false,
      transparent: true,
    }),
  );
  private readonly patches = new Mesh(
    new BufferGeometry(),
    new MeshBasicMaterial({
      color,
      opacity: patchOpacity,
      side: DoubleSide,
      depthTest: false,
      transparent: true,
    }),
  );
  private labels: TextLabel[] = [];
  private size: ViewSize | null = null;

  constructor(private readonly makeLabel: () => TextLabel = () => new Label('#ffffff')) {
    this.patches.renderOrder = 8;
    this.lines.renderOrder = this.ends.renderOrder = 9;
    this.lines.frustumCulled = this.ends.frustumCulled = this.patches.frustumCulled = false;
    this.object.add(this.lines, this.ends, this.patches);
    this.show([], []);
  }

  // `chosen`: points of what is not measured yet.
  show(measured: readonly Measured[], chosen: readonly Place[]): void {
    const shapes = measured.map(shapeOf);
    fill(this.ends, [...shapes.flatMap(({ ends }) => ends), ...chosen]);
    fill(
      this.patches,
      shapes.flatMap(({ triangles }) => triangles),
    );
    const lines = [...shapes.flatMap((shape) => shape.lines), ...linesThrough(chosen)];
    this.lines.geometry.dispose();
    this.lines.geometry = new LineSegmentsGeometry();
    this.lines.visible = lines.length > 0;
    if (lines.length > 0) this.lines.geometry.setPositions(lines.flat());
    this.write(measured.map(({ words }, i) => ({ text: words, place: shapes[i]!.labelPlace })));
  }

  onResize(size: ViewSize): void {
    this.size = size;
    for (const label of this.labels) label.resize(size);
  }

  dispose(): void {
    this.write([]);
    for (const { geometry, material } of [this.lines, this.ends, this.patches]) {
      geometry.dispose();
      material.dispose();
    }
  }

  private write(all: readonly { readonly text: string; readonly place: Place }[]): void {
    for (const label of this.labels) {
      this.object.remove(label.object);
      label.dispose();
    }
    this.labels = all.map(({ text, place }) => {
      const label = this.makeLabel();
      label.object.position.set(...place);
      label.say(text);
      if (this.size) label.resize(this.size);
      this.object.add(label.object);
      return label;
    });
  }
}

function fill(
  object: Points<BufferGeometry> | Mesh<BufferGeometry>,
  places: readonly Place[],
): void {
  object.geometry.dispose();
  object.geometry = new BufferGeometry();
  object.geometry.setAttribute(
    'position',
    new BufferAttribute(Float32Array.from(places.flat()), 3),
  );
  object.visible = places.length > 0;
}
