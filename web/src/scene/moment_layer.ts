// A moment of the recording: where the camera was, with its image in front of it.
import {
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  Quaternion,
  SRGBColorSpace,
  Vector3,
} from 'three';
import type { CameraIntrinsics, Pose, ScanEvent } from '../connection/events';
import { frustumCorners, frustumLines } from './frustum_layer';
import type { Layer } from './layer';

const depth_m = 0.3; // of its image
const color = 0xe8590c; // shows on a light ground and on a dark one
const hidden_m = 0.06; // whoever looks through the camera does not want to look at its image
const whole_m = 0.25;

export interface Moment {
  readonly worldFromCamera: Pose;
  readonly image: HTMLCanvasElement | null; // what is drawn there now; null: it is on its way
}

export class MomentLayer implements Layer {
  readonly object = new Group();
  private readonly lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color }));
  private readonly plane = new Mesh(
    new BufferGeometry(),
    new MeshBasicMaterial({ side: DoubleSide, transparent: true, toneMapped: false }),
  );

  constructor() {
    this.object.add(this.lines, this.plane);
    this.object.visible = false;
    this.lines.frustumCulled = this.plane.frustumCulled = false;
    this.plane.onBeforeRender = (_renderer, _scene, camera) => {
      const away_m = camera.position.distanceTo(this.object.getWorldPosition(new Vector3()));
      this.plane.material.opacity = Math.min(
        1,
        Math.max(0, (away_m - hidden_m) / (whole_m - hidden_m)),
      );
    };
  }

  onEvent(event: ScanEvent): void {
    if (event.kind === 'welcome' && event.camera) this.shape(event.camera);
  }

  show(moment: Moment | null): void {
    this.object.visible = moment !== null && this.lines.geometry.hasAttribute('position');
    this.plane.visible = moment?.image != null;
    if (!moment) return;
    this.object.position.fromArray(moment.worldFromCamera.translation);
    this.object.quaternion.copy(new Quaternion(...moment.worldFromCamera.rotation));
    if (moment.image) this.paint(moment.image);
  }

  dispose(): void {
    for (const { geometry, material } of [this.lines, this.plane]) {
      geometry.dispose();
      material.dispose();
    }
    this.plane.material.map?.dispose();
  }

  // A texture keeps the size that it had first.
  private paint(image: HTMLCanvasElement): void {
    const { material } = this.plane;
    const map = material.map as CanvasTexture | null;
    if (map && map.image === image && map.userData['width'] === image.width) {
      map.needsUpdate = true;
      return;
    }
    map?.dispose();
    material.map = new CanvasTexture(image);
    material.map.colorSpace = SRGBColorSpace;
    material.map.userData['width'] = image.width;
    material.needsUpdate = true;
  }

  private shape(camera: CameraIntrinsics): void {
    this.lines.geometry.setAttribute(
      'position',
      new BufferAttribute(frustumLines(camera, depth_m), 3),
    );
    const corners = frustumCorners(camera, depth_m);
    this.plane.geometry.setAttribute(
      'position',
      new BufferAttribute(Float32Array.from(corners.flat()), 3),
    );
    this.plane.geometry.setAttribute(
      'uv',
      new BufferAttribute(Float32Array.from([0, 1, 1, 1, 1, 0, 0, 0]), 2),
    );
    this.plane.geometry.setIndex([0, 1, 2, 0, 2, 3]);
  }
}
