// The image of one scan. Draws only when something changed: an idle page costs nothing.
import { Quaternion, Scene, Vector3, WebGLRenderer, type Object3D } from 'three';
import type { Pose, ScanEvent } from '../connection/events';
import type { Measured, Place } from '../connection/measurements';
import type { NoteView } from '../connection/notes';
import type { Axes } from '../state/axes';
import type { Cutting, Face, Model } from '../state/cutting';
import type { BoxEdit } from '../state/editing';
import { asksForSurface, type ViewOptions } from '../state/view_options';
import { CameraRig } from './camera_rig';
import { ClipLayer } from './clip_layer';
import { EyeDome } from './eye_dome';
import { framingOf, type Box } from './framing';
import type { FreePart } from './free_part';
import { FrustumLayer } from './frustum_layer';
import { floorHeight_m, type Direction } from './gravity';
import { GridLayer } from './grid_layer';
import { HiddenParts } from './hidden_parts';
import { ImagePacing, type Motion } from './image_pacing';
import type { Layer, ViewSize } from './layer';
import { LiveMeshLayer } from './live_mesh_layer';
import { MeasureLayer } from './measure_layer';
import { MeshLayer, trianglesIn } from './mesh_layer';
import { ModelCut, type SurfaceKind } from './model_cut';
import { MomentLayer, type Moment } from './moment_layer';
import { NoteLayer, type NotePin } from './note_layer';
import { OnPage } from './on_page';
import { PointsLayer } from './points_layer';
import { SampleCollector } from './samples';
import { SubmapsLayer } from './submaps_layer';
import { fillParent, paintGround } from './stage';
import { onThemeChange } from './theme';
import { TrajectoryLayer } from './trajectory_layer';
import { Upright } from './upright';

const reframeEvery_ms = 400;
const ahead_m = 1.5; // what whoever looks through the camera turns around

export class ScanScene {
  readonly images = new ImagePacing((elapsed_ms, now_ms) => this.draw(elapsed_ms, now_ms));
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly rig: CameraRig;
  private readonly page: OnPage;
  private readonly upright = new Upright((delta) => this.rig.carry(delta));
  private readonly submaps = new SubmapsLayer();
  private readonly clip = new ClipLayer();
  private readonly hidden = new HiddenParts();
  private readonly points = new PointsLayer(this.submaps, this.hidden);
  private readonly live = new LiveMeshLayer(this.submaps, this.hidden);
  private readonly mesh = new MeshLayer(this.hidden.uniforms);
  private readonly cut = new ModelCut({
    points: this.points,
    live: this.live,
    mesh: this.mesh,
    clip: this.clip,
    hidden: this.hidden,
  });
  private readonly eyeDome = new EyeDome();
  private readonly frustum = new FrustumLayer();
  private readonly measured = new MeasureLayer();
  private readonly moment = new MomentLayer();
  private readonly notes = new NoteLayer();
  private readonly grid = new GridLayer();
  // What hangs on the submaps comes behind them.
  private readonly layers: readonly Layer[] = [
    ...[
      this.grid,
      this.submaps,
      this.points,
      this.live,
      this.mesh,
      this.eyeDome,
      new TrajectoryLayer(this.submaps),
      this.frustum,
    ],
    ...[this.clip, this.cut.section, this.measured, this.moment, this.notes],
  ];
  private readonly stillness = matchMedia('(prefers-reduced-motion: reduce)');
  private readonly unwatchTheme: () => void;
  private readonly resizeObserver: ResizeObserver;
  private reframed_ms = 0;
  private grew = false;
  private growing = true; // more may come
  private imported = false; // it came with its own up
  private floor_m: number | null = null; // below the world's origin, along gravity
  private running = false;
  private options: ViewOptions | null = null;

  // Throws when the browser has no WebGL 2. `onTouched`: the viewer took the
  // view into their own hands.
  constructor(
    private readonly canvas: HTMLCanvasElement,
    onTouched: () => void,
  ) {
    this.renderer = new WebGLRenderer({
      canvas,
      antialias: true,
      powerPreference: 'high-performance',
    });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.info.autoReset = false; // an image may take two render passes
    for (const layer of this.layers)
      (layer === this.grid ? this.scene : this.upright.object).add(layer.object);
    this.scene.add(this.upright.object);
    this.paint();
    this.unwatchTheme = onThemeChange(() => this.paint());
    this.rig = new CameraRig(canvas, () => this.images.request(), onTouched);
    this.page = new OnPage(canvas, this.rig.camera, this.upright, {
      points: this.points,
      live: this.live,
      mesh: this.mesh,
      hidden: this.hidden,
    });
    this.resizeObserver = new ResizeObserver(() => this.resize());
    this.resizeObserver.observe(canvas.parentElement ?? canvas);
    canvas.addEventListener('webglcontextrestored', () => this.images.request());
    this.resize();
  }

  onEvent(event: ScanEvent): void {
    for (const layer of this.layers) layer.onEvent?.(event);
    if (event.kind === 'chunk' || event.kind === 'meshChunk' || event.kind === 'submapPoses')
      this.grew = true;
    if (event.kind === 'scanState') {
      this.running = event.phase === 'running';
      this.imported = event.phase === 'finished' && event.received === 0;
      this.upright.measure(event.up);
      if (this.imported) this.upright.forget();
    }
    if (event.kind === 'closed') {
      this.growing = false;
      this.grew = true; // looked at a last time
    }
    if (event.kind === 'meshChunk' || event.kind === 'scanState') this.chooseShown();
    this.images.requestInTime();
  }

  onOptions(options: ViewOptions): void {
    this.options = options;
    for (const layer of this.layers) layer.onOptions?.(options);
    this.chooseShown();
    this.rig.follow(options.follow);
    this.images.request();
  }

  // The surface of the scan, in glTF's frame; it is disposed of with the scene.
  showMesh(root: Object3D): { readonly triangles: number; readonly textured: boolean } {
    this.mesh.replace(root);
    this.live.clear();
    this.cut.refresh();
    if (this.options) this.onOptions(this.options);
    return { triangles: trianglesIn(root), textured: this.mesh.isTextured };
  }

  // The finished surface, or the growing one, or points. What the growing one had not come to when
  // the scan ended is there as points.
  private chooseShown(): void {
    const finished = this.mesh.object.visible;
    const live =
      !finished &&
      this.live.isThere &&
      this.options !== null &&
      asksForSurface(this.options, this.live.hasConfidences);
    this.live.setVisible(live);
    this.points.setVisible(!finished && !(live && this.running));
  }

  // What somebody has said is up, in the world of the scan; null: it is found from the surface.
  setUp(up: Direction | null): void {
    this.upright.choose(up);
    this.grew = true;
    this.reframed_ms = -Infinity;
    this.images.request();
  }

  // What faces whoever clicks there, in pixels of the page, is the floor from now
  // on; null: nothing is there.
  floorAt(x_px: number, y_px: number): Direction | null {
    const up = this.page.facingAt(x_px, y_px);
    if (up) this.setUp(up);
    return up;
  }

  // What is there becomes the middle of all turning.
  pivotAt(x_px: number, y_px: number): boolean {
    const hit = this.page.hitAt(x_px, y_px);
    if (hit) this.lookAt(hit.point_m.toArray());
    return hit !== null;
  }

  // Where somebody has clicked, in the world of the scan; null: nothing is there.
  placeAt(x_px: number, y_px: number): Place | null {
    return this.page.hitAt(x_px, y_px)?.point_m.toArray() ?? null;
  }

  // Where that is in the image, in pixels of the page; null: behind the viewer.
  screenOf(place: Place): readonly [number, number] | null {
    return this.page.placeOf(place);
  }

  // In the world of the scan.
  get up(): Direction {
    return this.upright.up;
  }

  showMeasured(measured: readonly Measured[], chosen: readonly Place[]): void {
    this.measured.show(measured, chosen);
    this.images.request();
  }

  showNotes(pins: readonly NotePin[]): void {
    this.notes.show(pins);
    this.images.request();
  }

  // How somebody looks now, in the world of the scan.
  get view(): NoteView {
    const [position_m, target_m] = this.rig.view.map((point) =>
      point.applyMatrix4(this.page.worldFromView).toArray(),
    );
    return { position_m: position_m!, target_m: target_m! };
  }

  // The same way again; also when up is found to be another one meanwhile.
  lookAs({ position_m, target_m }: NoteView): void {
    this.rig.lookFrom(this.page.inView(position_m), this.page.inView(target_m));
  }

  // From where somebody looks now, turned to that place.
  lookAt(place: Place): void {
    this.rig.pivot(this.page.inView(place));
  }

  // Returns the bounds of the model along these axes, or along the directions of its walls;
  // null if the model is empty.
  measureModel(axes: Axes | null): Model | null {
    return this.cut.measure(axes, this.up, this.floor_m === null ? null : -this.floor_m);
  }

  // Which surface a section would cut.
  get surface(): SurfaceKind {
    return this.cut.surface;
  }

  // Returns the lines where the section cuts the surface (section.ts).
  showCutting(cutting: Cutting): readonly number[] {
    this.images.request();
    return this.cut.show(cutting);
  }

  // Hides what they have taken out, and frames what they have left.
  showEdits(edits: readonly BoxEdit[]): void {
    this.hidden.setEdits(edits);
    this.grew = true;
    this.images.request();
  }

  // Returns the face of the clip box whose handle is within `reach_px` of this
  // point of the page, or null.
  handleAt(x_px: number, y_px: number, reach_px: number): Face | null {
    const away_px = (place: Place): number => {
      const [x, y] = this.screenOf(place) ?? [Infinity, Infinity];
      return Math.hypot(x - x_px, y - y_px);
    };
    return this.cut.handleAt(away_px, reach_px);
  }

  // Returns where a face of the clip box lies on its axis when it is dragged to this point of the
  // page; null if the view is along the axis.
  dragged(face: Face, x_px: number, y_px: number): number | null {
    return this.cut.alongHandle(face, this.page.rayAt(x_px, y_px));
  }

  // Where the camera was at a moment that somebody looks back at; null: nobody does.
  showMoment(moment: Moment | null): void {
    this.moment.show(moment);
    this.images.request();
  }

  // From where the camera was, as it looked.
  lookThrough({ translation, rotation }: Pose): void {
    const target = new Vector3(0, 0, ahead_m)
      .applyQuaternion(new Quaternion(...rotation))
      .add(new Vector3(...translation));
    this.lookAs({ position_m: translation, target_m: target.toArray() });
  }

  // How many points there are of each confidence, which is an eighth of the index; while the
  // surface alone is shown, how many of its vertices.
  confidences(): Uint32Array {
    return (this.points.object.visible ? this.points : this.live).confidences();
  }

  // In one image.
  get drawCalls(): number {
    return this.renderer.info.render.calls;
  }

  // No panel covers that.
  setFreePart(free: FreePart): void {
    this.rig.setFreePart(free);
  }

  frameAll(): void {
    this.rig.frameAll();
  }

  dispose(): void {
    this.images.dispose();
    this.resizeObserver.disconnect();
    this.unwatchTheme();
    for (const layer of this.layers) layer.dispose();
    this.rig.dispose();
    this.renderer.dispose();
  }

  private draw(elapsed_ms: number, now_ms: number): Motion {
    let moving = false;
    const still = this.stillness.matches;
    for (const layer of this.layers) moving = (layer.tick?.(elapsed_ms) ?? false) || moving;
    if (this.upright.tick(elapsed_ms, still)) moving = this.grew = true; // framed anew as it turns
    const eye = this.rig.tick(elapsed_ms, this.frustum.worldFromCamera, {
      upright: this.upright.object.quaternion,
      still,
    });
    if (this.reframe(now_ms)) moving = true;
    this.hidden.place(this.upright.object.matrix);
    this.renderer.info.reset();
    this.eyeDome.draw(this.renderer, this.scene, this.rig.camera, this.points.object, this.isLit());
    if (eye.byHand) return 'byHand';
    return moving || eye.byItself ? 'byItself' : 'none';
  }

  // True while it still has to happen: the boxes of a large scan are not gone
  // through for every image.
  private reframe(now_ms: number): boolean {
    if (!this.grew) return false;
    if (now_ms - this.reframed_ms < reframeEvery_ms) return true;
    this.grew = false;
    this.reframed_ms = now_ms;
    const boxes = [...this.points.boxes(), ...this.live.boxes()];
    this.findUp(boxes, now_ms);
    const left = boxes.filter(({ min_m, max_m }) =>
      this.hidden.isLeft(new Vector3(...min_m).add(new Vector3(...max_m)).multiplyScalar(0.5)),
    );
    const framing = framingOf(
      (left.length > 0 ? left : boxes).map((box) => this.upright.turned(box)),
    );
    if (!framing) return false;
    const placed = this.floor_m === null ? framing : { ...framing, floor_y_m: this.floor_m };
    this.grid.placeUnder(placed);
    this.rig.setFraming(placed);
    return true;
  }

  private findUp(boxes: readonly Box[], now_ms: number): void {
    if (this.imported || (this.growing && !this.upright.isDue(now_ms))) return;
    const samples = new SampleCollector(boxes.reduce((sum, box) => sum + box.weight, 0));
    this.points.sample(samples);
    this.live.sample(samples);
    const taken = samples.take();
    this.upright.estimate(taken, now_ms, !this.growing);
    const height_m = floorHeight_m(taken, this.upright.up);
    this.floor_m = height_m === null ? null : -height_m;
  }

  // Eye-dome lighting applies to points only: surfaces are shaded by their normals.
  private isLit(): boolean {
    return (
      this.points.object.visible && !this.live.object.visible && this.options?.eyeDome === true
    );
  }

  private paint(): void {
    paintGround(this.scene, this.grid);
    this.images.request();
  }

  private resize(): void {
    const aspect = fillParent(this.renderer);
    if (aspect === null) return;
    this.rig.resize(aspect);
    const size: ViewSize = {
      width_px: this.canvas.width,
      height_px: this.canvas.height,
      verticalFov_rad: this.rig.verticalFov_rad,
    };
    for (const layer of this.layers) layer.onResize?.(size);
    this.images.request();
  }
}
