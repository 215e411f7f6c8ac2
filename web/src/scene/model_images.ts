// Images of a model for a page: from above and from four sides, as good as without perspective, so
// that lengths can be read off them. Draws once, when all is there, into canvases of their own.
import {
  Color,
  Group,
  PerspectiveCamera,
  Quaternion,
  Scene,
  Vector3,
  WebGLRenderer,
  type Object3D,
} from 'three';
import type { MeasuredUp, ScanEvent } from '../connection/events';
import { threeOf, type Axes, type Triple } from '../state/axes';
import {
  extentOf,
  figuresOf,
  weighedByArea,
  type Extent,
  type ModelFigures,
} from '../state/model_figures';
import type { Surface } from '../state/section';
import { initialViewOptions, type ViewOptions } from '../state/view_options';
import { bestUp, floorHeight_m, firstCamerasUp, type Direction } from './gravity';
import { hasWalls, wallAxes } from './heading';
import { MeshLayer } from './mesh_layer';
import { boundsAlong } from './model_bounds';
import { PointsLayer } from './points_layer';
import { SampleCollector } from './samples';
import { SubmapsLayer } from './submaps_layer';

export const strayShare = 0.005; // of the surface, or the points, at either end of each axis
const widest_px = 760;
const tallest = 1.25; // of the width
const margin = 1.06;
// The camera is so many times as far away as the model is deep: what is near is at most a hundredth
// larger than what is far.
const awayDepths = 100;
const leap_m = 0.5; // between two frames: the camera was lost
const pathStrokes = [
  [10, 'rgb(255 255 255 / 0.85)'],
  [5, '#0c5f8a'],
] as const; // seen on any ground
const lowConfidence = 6; // twice what a point needs to be kept

export type ViewName = 'above' | 'ahead' | 'right' | 'back' | 'left';

export interface ModelImage {
  readonly view: ViewName;
  readonly canvas: HTMLCanvasElement;
  readonly width_m: number; // of the whole image
}

export interface ModelLook {
  readonly extent: Extent;
  // Of all of the model, or of what is left of these without strays.
  readonly extentOf: 'all' | 'surface' | 'points';
  readonly hasWalls: boolean; // that its axes are turned to
  readonly figures: ModelFigures | null; // null: there is no surface
  readonly hasPath: boolean; // of the camera, in the image from above
  readonly images: readonly ModelImage[];
  readonly confidence: { readonly image: ModelImage; readonly lowShare: number } | null;
}

// The browser makes no images.
export class NoWebGl extends Error {}

interface View {
  readonly name: ViewName;
  readonly sight: Triple; // where it looks, in the world
  readonly above: Triple; // what is up in the image
  readonly size: readonly [number, number, number]; // axes that are its width, height and depth
}

export class ModelImages {
  private readonly submaps = new SubmapsLayer();
  private readonly points = new PointsLayer(this.submaps);
  private readonly mesh = new MeshLayer();
  private path_m = new Float32Array(); // of the camera, in the world
  private chosenUp: Direction | null;
  private measuredUp: MeasuredUp | null = null;
  private imported = false;

  // `up`: as somebody has said, null: it is found.
  constructor(up: Direction | null) {
    this.chosenUp = up;
  }

  onEvent(event: ScanEvent): void {
    this.submaps.onEvent(event);
    this.points.onEvent(event);
    if (event.kind === 'scanState') {
      this.measuredUp = event.up;
      this.imported = event.phase === 'finished' && event.received === 0;
    }
    if (event.kind === 'trajectory' && !event.submaps)
      this.path_m = Float32Array.from(event.positions_m);
  }

  showMesh(root: Object3D): { readonly triangles: number; readonly textured: boolean } {
    this.mesh.replace(root);
    const triangles = this.mesh.surfaces().reduce((sum, { index }) => sum + index.length / 3, 0);
    return { triangles, textured: this.mesh.isTextured };
  }

  // Null when there is nothing to see. Throws NoWebGl when the browser has no WebGL 2.
  draw(): ModelLook | null {
    this.submaps.tick(Infinity);
    const surfaces = this.mesh.surfaces();
    const samples = this.samples();
    const up =
      this.chosenUp ?? (this.imported ? null : bestUp(samples, this.measuredUp)) ?? firstCamerasUp;
    const axes = wallAxes(samples, up);
    const all = boundsAlong(axes, this.points.boxes(), surfaces);
    if (!all) return null;
    const trimmed = this.trimmed(surfaces, samples.positions_m, axes);
    const extent =
      trimmed?.extent ??
      boundsAlong(axes, this.mesh.isThere ? [] : this.points.boxes(), surfaces) ??
      all;
    const floor_m = floorHeight_m(samples, up);
    const figures = this.mesh.isThere ? figuresOf(surfaces, axes, all, floor_m) : null;
    const seen = union(extent, extentOf({ positions_m: this.path_m, weights: null }, axes, 0));
    const whole = union(all, seen);
    const studio = new Studio(
      axes,
      seen,
      Math.hypot(...whole.low_m.map((low, k) => whole.high_m[k]! - low)),
    );
    try {
      return {
        extent,
        extentOf: trimmed?.of ?? 'all',
        hasWalls: hasWalls(samples, up),
        figures,
        hasPath: this.path_m.length > 0,
        ...this.images(studio, axes),
      };
    } finally {
      studio.dispose();
    }
  }

  dispose(): void {
    this.points.dispose();
    this.mesh.dispose();
    this.submaps.dispose();
  }

  // Without strays. Null: there are none, as in what was imported, whose far ends somebody has
  // made; or nothing is known.
  private trimmed(
    surfaces: readonly Surface[],
    points_m: Float32Array,
    axes: Axes,
  ): { readonly extent: Extent; readonly of: 'surface' | 'points' } | null {
    if (this.imported && this.mesh.isThere) return null;
    const weighed = this.mesh.isThere
      ? weighedByArea(surfaces)
      : { positions_m: points_m, weights: null };
    const extent = extentOf(weighed, axes, strayShare);
    return extent && { extent, of: this.mesh.isThere ? 'surface' : 'points' };
  }

  private samples() {
    const total = this.points.boxes().reduce((sum, { weight }) => sum + weight, 0);
    const samples = new SampleCollector(
      this.mesh.isThere
        ? this.mesh.surfaces().reduce((sum, { positions_m }) => sum + positions_m.length / 3, 0)
        : total,
    );
    (this.mesh.isThere ? this.mesh : this.points).sample(samples);
    return samples.take();
  }

  private images(studio: Studio, axes: Axes): Pick<ModelLook, 'images' | 'confidence'> {
    const [above, ...sides] = viewsOf(axes);
    studio.add(this.points.object, this.mesh.object);
    this.look({ ...initialViewOptions, show: 'surface' }, !this.mesh.isThere);
    const draw = (view: View): ModelImage =>
      studio.image(view, (size) => this.points.onResize(size));
    const plan = studio.withPath(draw(above), this.path_m);
    const images = [plan, ...sides.map(draw)];
    const confidences = this.points.confidences();
    const total = confidences.reduce((sum, count) => sum + count, 0);
    if (this.imported || total === 0) return { images, confidence: null };
    this.look({ ...initialViewOptions, show: 'points', color: 'confidence' }, true);
    const low = confidences.subarray(0, 8 * lowConfidence).reduce((sum, count) => sum + count, 0);
    return { images, confidence: { image: draw(above), lowShare: low / total } };
  }

  // What is seen from behind is left out, so that a room can be looked into.
  private look(options: ViewOptions, points: boolean): void {
    this.points.onOptions(options);
    this.mesh.onOptions(options);
    this.points.object.visible = points;
    for (const side of this.mesh.object.children) side.visible = side.renderOrder === 0;
  }
}

function union(a: Extent, b: Extent | null): Extent {
  if (!b) return a;
  const [low, high] = [
    a.low_m.map((low_m, k) => Math.min(low_m, b.low_m[k]!)),
    a.high_m.map((high_m, k) => Math.max(high_m, b.high_m[k]!)),
  ];
  return { low_m: low as unknown as Triple, high_m: high as unknown as Triple };
}

// `across` points backwards: the first camera looked the other way.
function viewsOf(axes: Axes): readonly [View, ...View[]] {
  const [along, up, across] = threeOf(axes);
  const minus = (a: Triple): Triple => [-a[0], -a[1], -a[2]];
  return [
    { name: 'above', sight: minus(up), above: minus(across), size: [0, 2, 1] },
    { name: 'ahead', sight: minus(across), above: up, size: [0, 1, 2] },
    { name: 'right', sight: along, above: up, size: [2, 1, 0] },
    { name: 'back', sight: across, above: up, size: [0, 1, 2] },
    { name: 'left', sight: minus(along), above: up, size: [2, 1, 0] },
  ];
}

function newRenderer(): WebGLRenderer {
  try {
    return new WebGLRenderer({ antialias: true, alpha: true });
  } catch (error) {
    throw new NoWebGl('There is no WebGL 2.', { cause: error });
  }
}

// Where images are taken, all at the same scale.
class Studio {
  private readonly renderer = newRenderer();
  private readonly scene = new Scene();
  // Turned upright because shaders light what is above in the world, where y points down.
  private readonly upright = new Group();
  private readonly camera = new PerspectiveCamera();
  private readonly turn: Quaternion;
  private readonly middle: Vector3;
  private readonly size_m: Triple;
  private readonly metresPerPixel: number;

  // `whole_m`: across all of the model, strays included.
  constructor(
    axes: Axes,
    { low_m, high_m }: Extent,
    private readonly whole_m: number,
  ) {
    this.renderer.setClearColor(new Color(0), 0);
    this.turn = new Quaternion().setFromUnitVectors(new Vector3(...axes.up), new Vector3(0, -1, 0));
    this.upright.quaternion.copy(this.turn);
    this.scene.add(this.upright);
    const sizes = [0, 1, 2].map((k) => Math.max(0.05, high_m[k]! - low_m[k]!)) as unknown as [
      number,
      number,
      number,
    ];
    this.size_m = sizes;
    this.middle = new Vector3();
    threeOf(axes).forEach((axis, k) =>
      this.middle.addScaledVector(new Vector3(...axis), (low_m[k]! + high_m[k]!) / 2),
    );
    this.middle.applyQuaternion(this.turn);
    const [along_m, up_m, across_m] = sizes;
    this.metresPerPixel =
      (margin * Math.max(along_m, across_m, up_m / tallest, across_m / tallest)) / widest_px;
  }

  add(...objects: Object3D[]): void {
    this.upright.add(...objects);
  }

  image(
    { name, sight, above, size }: View,
    resize: (size: { width_px: number; height_px: number; verticalFov_rad: number }) => void,
  ): ModelImage {
    const [, height_m, depth_m] = size.map((axis) => this.size_m[axis]!) as [
      number,
      number,
      number,
    ];
    const height_px = Math.max(60, Math.ceil((margin * height_m) / this.metresPerPixel));
    const away_m = awayDepths * Math.max(depth_m, height_m);
    const verticalFov_rad = 2 * Math.atan((height_px * this.metresPerPixel) / 2 / away_m);
    this.renderer.setSize(widest_px, height_px, false);
    resize({ width_px: widest_px, height_px, verticalFov_rad });
    this.camera.fov = (verticalFov_rad * 180) / Math.PI;
    this.camera.aspect = widest_px / height_px;
    this.camera.near = Math.max(0.1 * away_m, away_m - this.whole_m);
    this.camera.far = away_m + this.whole_m;
    this.camera.up.set(...above).applyQuaternion(this.turn);
    this.camera.position
      .set(...sight)
      .applyQuaternion(this.turn)
      .multiplyScalar(-away_m)
      .add(this.middle);
    this.camera.lookAt(this.middle);
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [widest_px, height_px];
    canvas.getContext('2d')!.drawImage(this.renderer.domElement, 0, 0);
    return { view: name, canvas, width_m: widest_px * this.metresPerPixel };
  }

  // Draws the way of the camera, from a dot on, into the image that was made last.
  withPath(image: ModelImage, path_m: Float32Array): ModelImage {
    if (path_m.length === 0) return image;
    const { canvas } = image;
    const drawing = canvas.getContext('2d')!;
    const line = new Path2D();
    const point = new Vector3();
    let before: Vector3 | null = null;
    for (let i = 0; i + 2 < path_m.length; i += 3) {
      const at = new Vector3().fromArray(path_m, i);
      point.copy(at).applyQuaternion(this.turn).project(this.camera);
      const [x, y] = [((point.x + 1) / 2) * canvas.width, ((1 - point.y) / 2) * canvas.height];
      if (before && before.distanceTo(at) < leap_m) line.lineTo(x, y);
      else line.moveTo(x, y);
      if (!before) line.arc(x, y, 8, 0, 2 * Math.PI);
      before = at;
    }
    drawing.lineJoin = 'round';
    for (const [width, color] of pathStrokes) {
      drawing.lineWidth = width;
      drawing.strokeStyle = color;
      drawing.stroke(line);
    }
    return image;
  }

  dispose(): void {
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}
