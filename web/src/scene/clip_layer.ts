// The clip box: what of the model is outside of it is neither drawn nor clicked on. While it is edited its edges are seen, with a handle on each face.
import { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Matrix4, Points, PointsMaterial, Vector3 } from 'three';
import { threeOf, type Axes } from '../state/axes';
import { faces, type Box, type Face } from '../state/cutting';
import type { Layer } from './layer';

const color = 0x3b8eea; // shows on a light ground and on a dark one
const handle_px = 16;
const slack_m = 2e-4; // what lies in a face is inside, as numbers are rounded
const everything = new Matrix4().set(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1); // all places are in the middle of the box

// For the shaders of the model: of a place inside no coordinate is beyond one.
export interface ClipUniform {
  readonly value: Matrix4; // clipFromScene
}

export const unclipped: ClipUniform = { value: everything };

export class ClipLayer implements Layer {
  readonly object = new Group();
  readonly uniform: ClipUniform = { value: everything.clone() };
  private readonly clipFromWorld = everything.clone();
  private readonly edges = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color }));
  private readonly handles = new Points(
    new BufferGeometry(),
    new PointsMaterial({ color, size: handle_px, sizeAttenuation: false, depthTest: false, transparent: true }),
  );
  private middles: readonly Vector3[] = []; // of the faces, as `faces` has them
  private directions: readonly Vector3[] = [];

  constructor() {
    this.handles.renderOrder = 9;
    this.edges.frustumCulled = this.handles.frustumCulled = false;
    this.object.add(this.edges, this.handles);
    this.object.visible = false;
  }

  // `edited`: with edges and handles. Null: everything is shown.
  show(axes: Axes | null, box: Box | null, edited: boolean): void {
    this.object.visible = box !== null && edited;
    this.middles = [];
    this.clipFromWorld.copy(everything);
    if (!axes || !box) return;
    this.directions = threeOf(axes).map((axis) => new Vector3(...axis));
    const at = (parts: readonly number[]): Vector3 =>
      parts.reduce((sum, part, k) => sum.addScaledVector(this.directions[k]!, part), new Vector3());
    const middle = box.low_m.map((low, k) => (low + box.high_m[k]!) / 2);
    const half = box.low_m.map((low, k) => (box.high_m[k]! - low) / 2 + slack_m);
    const [x, y, z] = this.directions.map((axis, k) => axis.clone().multiplyScalar(half[k]!)) as [Vector3, Vector3, Vector3];
    this.clipFromWorld.makeBasis(x, y, z).setPosition(at(middle)).invert();
    this.middles = faces.map(({ axis, side }) => at(middle.map((value, k) => (k === axis ? box[side][k]! : value))));
    const corner = (i: number): Vector3 => at([0, 1, 2].map((k) => ((i >> k) & 1 ? box.high_m[k]! : box.low_m[k]!)));
    fill(
      this.edges,
      [0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [1, 2, 4].flatMap((bit) => (i & bit ? [] : [corner(i), corner(i | bit)]))),
    );
    fill(this.handles, this.middles);
  }

  // Of the shaders; the world of the scan turns until up is up.
  place(sceneFromWorld: Matrix4): void {
    this.uniform.value.copy(sceneFromWorld).invert().premultiply(this.clipFromWorld);
  }

  // In the world of the scan.
  holds(point_m: Vector3): boolean {
    const { x, y, z } = point_m.clone().applyMatrix4(this.clipFromWorld);
    return Math.max(Math.abs(x), Math.abs(y), Math.abs(z)) <= 1;
  }

  // Where it can be taken hold of, and where it moves along; in the world of the scan. Null: it is not edited.
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

function fill(object: LineSegments<BufferGeometry> | Points<BufferGeometry>, points: readonly Vector3[]): void {
  object.geometry.dispose();
  object.geometry = new BufferGeometry();
  object.geometry.setAttribute('position', new BufferAttribute(Float32Array.from(points.flatMap((point) => point.toArray())), 3));
}
