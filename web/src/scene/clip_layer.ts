// The edges of the clip box while it is edited, with a handle on each face.
import {
  BufferAttribute,
  BufferGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Points,
  PointsMaterial,
  Vector3,
} from 'three';
import { threeOf, type Axes } from '../state/axes';
import { faces, type Box, type Face } from '../state/cutting';
import type { Layer } from './layer';

const color = 0x3b8eea; // shows on a light ground and on a dark one
const handle_px = 16;

export class ClipLayer implements Layer {
  readonly object = new Group();
  private readonly edges = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color }));
  private readonly handles = new Points(
    new BufferGeometry(),
    new PointsMaterial({
      color,
      size: handle_px,
      sizeAttenuation: false,
      depthTest: false,
      transparent: true,
    }),
  );
  private middles: readonly Vector3[] = []; // of the faces, as `faces` has them
  private directions: readonly Vector3[] = [];

  constructor() {
    this.handles.renderOrder = 9;
    this.edges.frustumCulled = this.handles.frustumCulled = false;
    this.object.add(this.edges, this.handles);
    this.object.visible = false;
  }

  show(axes: Axes | null, box: Box | null, edited: boolean): void {
    this.object.visible = box !== null && edited;
    this.middles = [];
    if (!axes || !box) return;
    this.directions = threeOf(axes).map((axis) => new Vector3(...axis));
    const at = (parts: readonly number[]): Vector3 =>
      parts.reduce((sum, part, k) => sum.addScaledVector(this.directions[k]!, part), new Vector3());
    const middle = box.low_m.map((low, k) => (low + box.high_m[k]!) / 2);
    this.middles = faces.map(({ axis, side }) =>
      at(middle.map((value, k) => (k === axis ? box[side][k]! : value))),
    );
    const corner = (i: number): Vector3 =>
      at([0, 1, 2].map((k) => ((i >> k) & 1 ? box.high_m[k]! : box.low_m[k]!)));
    fill(
      this.edges,
      [0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) =>
        [1, 2, 4].flatMap((bit) => (i & bit ? [] : [corner(i), corner(i | bit)])),
      ),
    );
    fill(this.handles, this.middles);
  }

  // Where it can be taken hold of, and where it moves along; in the world of the
  // scan. Null: it is not edited.
  handleOf(face: Face): { readonly at_m: Vector3; readonly along: Vector3 } | null {
    const at_m = this.object.visible
      ? this.middles[faces.findIndex(({ axis, side }) => axis === face.axis && side === face.side)]
      : undefined;
    return at_m ? { at_m, along: this.directions[face.axis]! } : null;
  }

  dispose(): void {
    for (const { geometry, material } of [this.edges, this.handles]) {
      geometry.dispose();
      material.dispose();
    }
  }
}

function fill(
  object: LineSegments<BufferGeometry> | Points<BufferGeometry>,
  points: readonly Vector3[],
): void {
  object.geometry.dispose();
  object.geometry = new BufferGeometry();
  object.geometry.setAttribute(
    'position',
    new BufferAttribute(Float32Array.from(points.flatMap((point) => point.toArray())), 3),
  );
}
