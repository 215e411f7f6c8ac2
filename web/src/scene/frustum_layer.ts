// The scanning camera: its field of view at the pose of the newest frame, amber while tracking is
// weak. While it is lost, the last good view in red, with a text that asks to go back there.
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from 'three';
import type {
  CameraIntrinsics,
  FrameEvent,
  PoseInSubmap,
  ScanEvent,
  TrackingName,
} from '../connection/events';
import { wayBackLabel } from '../state/text';
import { Label } from './label';
import type { Layer, ViewSize } from './layer';
import { composed, GlidingPose } from './motion';

const depth_m = 0.22;
const glide_ms = 150;
const colors: Record<TrackingName, number> = { tracked: 0x7fd1b9, weak: 0xe0b15c, lost: 0xe8837a };

export class FrustumLayer implements Layer {
  readonly object: LineSegments<BufferGeometry, LineBasicMaterial>;
  readonly worldFromCamera = new GlidingPose(glide_ms);

  private inSubmap: PoseInSubmap | null = null;
  private ended = false; // nobody scans any more, and nobody is asked to go back anywhere
  private newest: FrameEvent | null = null;

  constructor(
    private readonly label: Pick<Label, 'object' | 'say' | 'resize' | 'dispose'> = new Label(
      '#e8837a',
    ),
  ) {
    this.object = new LineSegments(
      new BufferGeometry(),
      new LineBasicMaterial({ color: colors.tracked }),
    );
    this.object.add(label.object);
    this.object.matrixAutoUpdate = false;
    this.object.frustumCulled = false;
    this.object.visible = false;
  }

  onEvent(event: ScanEvent): void {
    if (event.kind === 'welcome' && event.camera) this.shape(event.camera);
    if (event.kind === 'frame') this.show(event);
    if (event.kind === 'scanState') this.end(event.phase !== 'running');
    if (event.kind !== 'submapPoses') return;
    const moved = event.poses.find((pose) => pose.submap === this.inSubmap?.submap);
    if (moved)
      this.worldFromCamera.moveTo(composed(moved.worldFromSubmap, this.inSubmap!.submapFromCamera));
  }

  onResize(size: ViewSize): void {
    this.label.resize(size);
  }

  tick(elapsed_ms: number): boolean {
    const moving = this.worldFromCamera.tick(elapsed_ms);
    if (moving) this.place();
    return moving;
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
    this.label.dispose();
  }

  private show(frame: FrameEvent): void {
    if (frame.tracking !== 'lost' || frame.lastTracked) {
      this.worldFromCamera.moveTo(frame.worldFromCamera);
      this.inSubmap = frame.inSubmap;
    }
    this.object.material.color.setHex(colors[frame.tracking]);
    this.newest = frame;
    this.label.say(this.ended ? '' : wayBackLabel(frame));
    this.place();
  }

  private end(ended: boolean): void {
    if (ended === this.ended) return;
    this.ended = ended;
    this.label.say(ended || !this.newest ? '' : wayBackLabel(this.newest));
    this.place();
  }

  private shape(camera: CameraIntrinsics): void {
    this.object.geometry.setAttribute(
      'position',
      new BufferAttribute(frustumLines(camera, depth_m), 3),
    );
  }

  private place(): void {
    this.object.visible =
      !this.ended && this.worldFromCamera.known && this.object.geometry.hasAttribute('position');
    this.worldFromCamera.matrix(this.object.matrix);
    this.object.matrixWorldNeedsUpdate = true;
  }
}

// Of an image pixel, in the camera's frame.
const pointAt =
  ({ fx, fy, cx, cy }: CameraIntrinsics, atDepth_m: number) =>
  (u: number, v: number): number[] => [
    ((u - cx) / fx) * atDepth_m,
    ((v - cy) / fy) * atDepth_m,
    atDepth_m,
  ];

// Of the image, in the camera's frame: the upper left one first, then
// clockwise as the image has it.
export function frustumCorners(camera: CameraIntrinsics, atDepth_m: number): number[][] {
  const { width, height } = camera;
  const at = pointAt(camera, atDepth_m);
  return [
    at(-0.5, -0.5),
    at(width - 0.5, -0.5),
    at(width - 0.5, height - 0.5),
    at(-0.5, height - 0.5),
  ];
}

// Line segments (pairs of points) in the camera's frame: four rays, the image's border, and a
// roof that says where up is.
export function frustumLines(camera: CameraIntrinsics, atDepth_m: number): Float32Array {
  const { width, height, fy } = camera;
  const at = pointAt(camera, atDepth_m);
  const corners = frustumCorners(camera, atDepth_m);
  const lines = corners.flatMap((corner, i) => [[0, 0, 0], corner, corner, corners[(i + 1) % 4]!]);
  // Of the two horizontal borders the roof stands on the upper one in space: y points down (some
  // recordings have a negative fy).
  const top = fy > 0 ? -0.5 : height - 0.5;
  const away = fy > 0 ? -height / 6 : height / 6;
  const roof = [
    at(width * 0.4, top),
    at(width * 0.5, top + away),
    at(width * 0.5, top + away),
    at(width * 0.6, top),
  ];
  return Float32Array.from([...lines, ...roof].flat());
}
