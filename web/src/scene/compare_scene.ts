// The image of two scans: one over the other, or side by side through one camera. Draws
// only when something changed.
import {
  Box3,
  BufferGeometry,
  Float32BufferAttribute,
  LineBasicMaterial,
  LineSegments,
  Ray,
  Raycaster,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three';
import type { ComparedChunk, RegionPlace } from '../connection/compared_points';
import { pointStates } from '../connection/compared_points';
import type { ChangedRegion } from '../connection/comparisons';
import type { MeasuredUp } from '../connection/events';
import { colorsOf, isShown, type Look } from '../state/comparing';
import { initialViewOptions } from '../state/view_options';
import { CameraRig } from './camera_rig';
import { fittingDistance_m, framingOf } from './framing';
import { floorHeight_m } from './gravity';
import { GridLayer } from './grid_layer';
import { GlidingPose } from './motion';
import { PointsLayer } from './points_layer';
import { SampleCollector } from './samples';
import { SubmapsLayer } from './submaps_layer';
import { fillParent, paintGround } from './stage';
import { onThemeChange } from './theme';
import { Upright } from './upright';

const longestStep_ms = 400; // after an idle time nothing leaps
const leastRadius_m = 0.35; // around a region that the camera flies to
const around = 1.6; // of a region's radius: what is beside it is seen, too
const boxMargin_m = 0.01;
const identity = { translation: [0, 0, 0], rotation: [0, 0, 0, 1] } as const;

interface Part {
  readonly scans: readonly (0 | 1)[];
  readonly x: number; // of the canvas, from below, in CSS pixels
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

export class CompareScene {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly rig: CameraRig;
  private readonly upright = new Upright((delta) => this.rig.carry(delta));
  private readonly submaps = new SubmapsLayer();
  private readonly points = [new PointsLayer(this.submaps), new PointsLayer(this.submaps)] as const;
  private readonly grid = new GridLayer();
  private readonly frame = boxLines();
  private readonly nobody = new GlidingPose(1);
  private readonly stillness = matchMedia('(prefers-reduced-motion: reduce)');
  private readonly unwatchTheme: () => void;
  private readonly resizeObserver: ResizeObserver;
  private chunks: readonly ComparedChunk[] = [];
  private look: Look = 'overlay';
  private frameRequest = 0;
  private last_ms = 0;
  private disposed = false;

  // Throws when the browser has no WebGL 2.
  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({
      canvas,
      antialias: true,
      powerPreference: 'high-performance',
    });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.info.autoReset = false; // an image may have two parts
    this.renderer.setScissorTest(true);
    this.submaps.onEvent({
      kind: 'submapPoses',
      poses: [{ submap: 0, worldFromSubmap: identity, part: 0 }],
    });
    for (const layer of this.points)
      layer.onOptions({ ...initialViewOptions, show: 'points', color: 'shaded' });
    this.upright.object.add(
      this.submaps.object,
      this.points[0].object,
      this.points[1].object,
      this.frame,
    );
    this.scene.add(this.grid.object, this.upright.object);
    this.paint();
    this.unwatchTheme = onThemeChange(() => this.paint());
    this.rig = new CameraRig(
      canvas,
      () => this.requestDraw(),
      () => {},
    );
    this.resizeObserver = new ResizeObserver(() => this.resize());
    this.resizeObserver.observe(canvas.parentElement ?? canvas);
    canvas.addEventListener('webglcontextrestored', () => this.requestDraw());
    canvas.addEventListener('dblclick', ({ clientX, clientY }) => this.pivotAt(clientX, clientY));
    this.resize();
  }

  // `measuredUp`: of the first scan, whose world this is.
  show(chunks: readonly ComparedChunk[], look: Look, measuredUp: MeasuredUp | null): void {
    this.chunks = chunks;
    this.upright.measure(measuredUp);
    this.setLook(look);
    const samples = new SampleCollector(chunks.reduce((sum, { points }) => sum + points.count, 0));
    for (const layer of this.points) layer.sample(samples);
    const taken = samples.take();
    this.upright.estimate(taken, performance.now(), true);
    this.upright.tick(longestStep_ms, true);
    const framing = framingOf(
      this.points.flatMap((layer) => layer.boxes()).map((box) => this.upright.turned(box)),
    );
    if (!framing) return;
    const height_m = floorHeight_m(taken, this.upright.up);
    const placed = height_m === null ? framing : { ...framing, floor_y_m: -height_m };
    this.grid.placeUnder(placed);
    this.rig.setFraming(placed);
  }

  setLook(look: Look): void {
    this.look = look;
    for (const chunk of this.chunks) {
      const { points, states, distances_m, scan, cube } = chunk;
      const radii_m = points.radii_m.map((radius_m, i) =>
        isShown(scan, pointStates[states[i]!]!, distances_m[i]!, look) ? radius_m : 0,
      );
      const [x, y, z] = cube;
      const key = { submap: 0, level: 0, x, y, z };
      this.points[scan].onEvent({
        kind: 'chunk',
        key,
        version: 0n,
        points: { ...points, radii_m, colors: colorsOf(chunk, look) },
      });
    }
    this.resize();
  }

  frameAll(): void {
    this.frame.visible = false;
    this.rig.frameAll();
  }

  // To where it is seen from the front, with a frame around it.
  flyTo(region: ChangedRegion, place: RegionPlace | undefined): void {
    const box = new Box3(
      new Vector3(...region.low_m),
      new Vector3(...region.high_m),
    ).expandByScalar(boxMargin_m);
    box.getCenter(this.frame.position);
    box.getSize(this.frame.scale);
    this.frame.updateMatrix();
    this.frame.visible = true;
    const { matrix, quaternion } = this.upright.object;
    const target = box.getCenter(new Vector3()).applyMatrix4(matrix);
    const [part] = this.parts();
    const radius_m = Math.max(leastRadius_m, around * 0.5 * box.getSize(new Vector3()).length());
    const distance_m = fittingDistance_m(
      radius_m,
      this.rig.verticalFov_rad,
      part!.width / part!.height,
    );
    const from = new Vector3(...(place?.normal ?? [0, 0, 0])).applyQuaternion(quaternion);
    if (from.lengthSq() < 0.5) from.subVectors(this.rig.view[0], this.rig.view[1]).normalize();
    from.y -= 0.35; // a little from above
    this.rig.lookFrom(from.normalize().multiplyScalar(distance_m).add(target), target);
  }

  get drawCalls(): number {
    return this.renderer.info.render.calls;
  }

  // Nothing moves, and all that has come is drawn.
  get isResting(): boolean {
    return this.frameRequest === 0;
  }

  dispose(): void {
    this.disposed = true;
    cancelAnimationFrame(this.frameRequest);
    this.resizeObserver.disconnect();
    this.unwatchTheme();
    for (const layer of [...this.points, this.submaps, this.grid]) layer.dispose();
    this.frame.geometry.dispose();
    this.frame.material.dispose();
    this.rig.dispose();
    this.renderer.dispose();
  }

  private pivotAt(x_px: number, y_px: number): void {
    const { left, top, height } = this.canvas.getBoundingClientRect();
    const [x, y] = [x_px - left, height - (y_px - top)];
    const part = this.parts().find(
      (one) => x >= one.x && x <= one.x + one.width && y >= one.y && y <= one.y + one.height,
    );
    if (!part) return;
    const caster = new Raycaster();
    caster.setFromCamera(
      new Vector2((2 * (x - part.x)) / part.width - 1, (2 * (y - part.y)) / part.height - 1),
      this.rig.camera,
    );
    const { matrix } = this.upright.object;
    const ray = new Ray().copy(caster.ray).applyMatrix4(matrix.clone().invert());
    const hits = part.scans
      .flatMap((scan) => this.points[scan].pick(ray) ?? [])
      .sort((a, b) => a.distance_m - b.distance_m);
    if (hits[0]) this.rig.pivot(hits[0].point_m.applyMatrix4(matrix));
  }

  // Side by side where the image is wide, one below the other where it is high.
  private parts(): Part[] {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (this.look === 'overlay') return [{ scans: [0, 1], x: 0, y: 0, width, height }];
    if (width >= height)
      return [0, 1].map((scan) => ({
        scans: [scan as 0 | 1],
        x: (scan * width) / 2,
        y: 0,
        width: width / 2,
        height,
      }));
    return [0, 1].map((scan) => ({
      scans: [scan as 0 | 1],
      x: 0,
      y: ((1 - scan) * height) / 2,
      width,
      height: height / 2,
    }));
  }

  private requestDraw(): void {
    if (this.frameRequest !== 0 || this.disposed) return;
    this.frameRequest = requestAnimationFrame((now_ms) => this.draw(now_ms));
  }

  private draw(now_ms: number): void {
    this.frameRequest = 0;
    const elapsed_ms = Math.min(longestStep_ms, Math.max(0, now_ms - this.last_ms));
    this.last_ms = now_ms;
    const still = this.stillness.matches;
    const eye = this.rig.tick(elapsed_ms, this.nobody, {
      upright: this.upright.object.quaternion,
      still,
    });
    this.renderer.info.reset();
    for (const { scans, x, y, width, height } of this.parts()) {
      this.points.forEach((layer, scan) => layer.setVisible(scans.includes(scan as 0 | 1)));
      this.renderer.setViewport(x, y, width, height);
      this.renderer.setScissor(x, y, width, height);
      this.renderer.render(this.scene, this.rig.camera);
    }
    if (eye.byHand || eye.byItself) this.requestDraw();
  }

  private paint(): void {
    paintGround(this.scene, this.grid);
    this.requestDraw();
  }

  private resize(): void {
    if (fillParent(this.renderer) === null) return;
    const [part] = this.parts();
    this.rig.resize(part!.width / part!.height);
    const ratio = this.renderer.getPixelRatio();
    for (const layer of this.points)
      layer.onResize({
        width_px: part!.width * ratio,
        height_px: part!.height * ratio,
        verticalFov_rad: this.rig.verticalFov_rad,
      });
    this.requestDraw();
  }
}

// The edges of a cube of one metre around the origin.
function boxLines(): LineSegments<BufferGeometry, LineBasicMaterial> {
  const ends: number[] = [];
  for (let corner = 0; corner < 8; ++corner)
    for (let axis = 0; axis < 3; ++axis) {
      if (corner & (1 << axis)) continue;
      for (const one of [corner, corner | (1 << axis)])
        ends.push((one & 1) - 0.5, ((one >> 1) & 1) - 0.5, ((one >> 2) & 1) - 0.5);
    }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(ends, 3));
  const lines = new LineSegments(geometry, new LineBasicMaterial({ color: 0xe0b15c }));
  lines.visible = false;
  lines.matrixAutoUpdate = false;
  lines.frustumCulled = false;
  return lines;
}
