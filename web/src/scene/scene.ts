// The picture of one scan. Draws only when something changed: an idle page costs nothing.
import { Color, Mesh, Scene, WebGLRenderer, type Object3D } from 'three';
import type { ScanEvent } from '../connection/events';
import type { ViewOptions } from '../state/view_options';
import { CameraRig } from './camera_rig';
import { framingOf } from './framing';
import { FrustumLayer } from './frustum_layer';
import { GridLayer } from './grid_layer';
import type { Layer, ViewSize } from './layer';
import { LiveMeshLayer } from './live_mesh_layer';
import { MeshLayer } from './mesh_layer';
import { PointsLayer } from './points_layer';
import { SubmapsLayer } from './submaps_layer';
import { TrajectoryLayer } from './trajectory_layer';

const background = new Color(0x0e1013);
const reframeEvery_ms = 400;
const longestStep_ms = 400; // after an idle time nothing leaps
const fpsWindow_ms = 2000;
const slowPicture_ms = 60;
const longestPause_ms = 1000;

export class ScanScene {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly rig: CameraRig;
  private readonly submaps = new SubmapsLayer();
  private readonly points = new PointsLayer(this.submaps);
  private readonly live = new LiveMeshLayer(this.submaps);
  private readonly mesh = new MeshLayer();
  private readonly frustum = new FrustumLayer();
  private readonly grid = new GridLayer();
  // What hangs on the submaps comes behind them.
  private readonly layers: readonly Layer[] = [this.grid, this.submaps, this.points, this.live, this.mesh, new TrajectoryLayer(this.submaps), this.frustum];
  private readonly resizeObserver: ResizeObserver;
  private frameRequest = 0;
  private pause: ReturnType<typeof setTimeout> | undefined;
  private requested_ms = 0;
  private picture_ms = 0; // how long a picture takes lately, from asking for it to drawing it
  private drawn_ms: number[] = [];
  private last_ms = 0;
  private reframed_ms = 0;
  private grew = false;
  private running = false;
  private options: ViewOptions | null = null;
  private disposed = false;

  // Throws when the browser has no WebGL 2. `onTouched`: the viewer took the view into their own hands.
  constructor(
    private readonly canvas: HTMLCanvasElement,
    onTouched: () => void,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: 'high-performance' });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.scene.background = background;
    for (const layer of this.layers) this.scene.add(layer.object);
    this.rig = new CameraRig(canvas, () => this.requestDraw(), onTouched);
    this.resizeObserver = new ResizeObserver(() => this.resize());
    this.resizeObserver.observe(canvas.parentElement ?? canvas);
    canvas.addEventListener('webglcontextrestored', () => this.requestDraw());
    this.resize();
  }

  onEvent(event: ScanEvent): void {
    for (const layer of this.layers) layer.onEvent?.(event);
    if (event.kind === 'chunk' || event.kind === 'meshChunk' || event.kind === 'submapPoses') this.grew = true;
    if (event.kind === 'scanState') this.running = event.phase === 'running';
    if (event.kind === 'meshChunk' || event.kind === 'scanState') this.chooseShown();
    this.requestDrawInTime();
  }

  onOptions(options: ViewOptions): void {
    this.options = options;
    for (const layer of this.layers) layer.onOptions?.(options);
    this.chooseShown();
    this.rig.follow(options.follow);
    this.requestDraw();
  }

  // The surface of the scan, in glTF's frame; it is disposed of with the scene.
  showMesh(root: Object3D): { readonly triangles: number; readonly textured: boolean } {
    this.mesh.replace(root);
    this.live.clear();
    if (this.options) this.onOptions(this.options);
    let triangles = 0;
    root.traverse((object) => {
      if (object instanceof Mesh) triangles += (object.geometry.index?.count ?? object.geometry.getAttribute('position').count) / 3;
    });
    return { triangles, textured: this.mesh.isTextured };
  }

  // The finished surface, or the growing one, or points. What the growing one had not come to when the scan ended is there as points.
  private chooseShown(): void {
    const finished = this.mesh.object.visible;
    const live = !finished && this.live.isThere && this.options?.show === 'surface';
    this.live.setVisible(live);
    this.points.setVisible(!finished && !(live && this.running));
  }

  frameAll(): void {
    this.rig.frameAll();
  }

  // Pictures a second, over the last two; 0 while nothing changes.
  framesPerSecond(): number {
    const since_ms = performance.now() - fpsWindow_ms;
    this.drawn_ms = this.drawn_ms.filter((time) => time >= since_ms);
    return Math.ceil(this.drawn_ms.length / (fpsWindow_ms / 1000));
  }

  dispose(): void {
    this.disposed = true;
    cancelAnimationFrame(this.frameRequest);
    clearTimeout(this.pause);
    this.resizeObserver.disconnect();
    for (const layer of this.layers) layer.dispose();
    this.rig.dispose();
    this.renderer.dispose();
  }

  private requestDraw(): void {
    clearTimeout(this.pause);
    this.pause = undefined; // first: a pause that has run out must not look like one that still runs
    if (this.frameRequest !== 0 || this.disposed) return;
    this.requested_ms = performance.now();
    this.frameRequest = requestAnimationFrame((now_ms) => this.draw(now_ms));
  }

  // For what changes by itself. Where pictures are slow (no graphics card), a pause leaves the processor to decoding and to the viewer's own hand.
  private requestDrawInTime(): void {
    if (this.picture_ms < slowPicture_ms) this.requestDraw();
    else this.pause ??= setTimeout(() => this.requestDraw(), Math.min(longestPause_ms, 3 * this.picture_ms));
  }

  private draw(now_ms: number): void {
    this.frameRequest = 0;
    this.picture_ms = 0.7 * this.picture_ms + 0.3 * (performance.now() - this.requested_ms);
    const elapsed_ms = Math.min(longestStep_ms, Math.max(0, now_ms - this.last_ms));
    this.last_ms = now_ms;
    let moving = false;
    for (const layer of this.layers) moving = (layer.tick?.(elapsed_ms) ?? false) || moving;
    const eye = this.rig.tick(elapsed_ms, this.frustum.worldFromCamera);
    if (this.reframe(now_ms)) moving = true;
    this.renderer.render(this.scene, this.rig.camera);
    this.drawn_ms.push(performance.now());
    if (this.drawn_ms.length > 480) this.framesPerSecond(); // forgets the old ones
    if (eye.byHand) this.requestDraw();
    else if (moving || eye.byItself) this.requestDrawInTime();
  }

  // True while it still has to happen: the boxes of a large scan are not gone through for every picture.
  private reframe(now_ms: number): boolean {
    if (!this.grew) return false;
    if (now_ms - this.reframed_ms < reframeEvery_ms) return true;
    this.grew = false;
    this.reframed_ms = now_ms;
    const framing = framingOf([...this.points.boxes(), ...this.live.boxes()]);
    if (!framing) return false;
    this.grid.placeUnder(framing);
    this.rig.setFraming(framing);
    return true;
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas.parentElement ?? this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.rig.resize(clientWidth / clientHeight);
    const size: ViewSize = { width_px: this.canvas.width, height_px: this.canvas.height, verticalFov_rad: this.rig.verticalFov_rad };
    for (const layer of this.layers) layer.onResize?.(size);
    this.requestDraw();
  }
}
