// Where the viewer's eye is: orbiting by hand, framing the scan by itself until touched, or
// riding behind the scanning camera. Up is -y of the view's world, which is the scan's, turned so
// that up is up (upright.ts).
import { PerspectiveCamera, Quaternion, Vector2, Vector3 } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { fittingDistance_m, type Framing } from './framing';
import { showInMiddle, wholeImage, type FreePart } from './free_part';
import type { GlidingPose } from './motion';

const verticalFov_deg = 50;
const settle_ms = 350; // time constant of the eye's own movements
// The eye begins behind the first camera, to the right and above.
const fromDirection = new Vector3(0.45, -0.8, -1).normalize();
const behind_m = new Vector3(0, -0.35, -0.9); // in the scanning camera's frame
const sphereShare = 0.88; // a scan is smaller than the sphere around it
// So much of the radius the scan is moved upwards on the screen, where panels at the bottom are too
// small to count (free_part.ts).
const lift = 0.1;
const ahead_m = new Vector3(0, 0, 1.5);

export interface Surroundings {
  readonly upright: Quaternion; // from the scan's world
  readonly still: boolean; // somebody does not like motion
}

export interface EyeMotion {
  readonly byHand: boolean; // and what is left of it afterwards
  readonly byItself: boolean;
}

export class CameraRig {
  readonly camera = new PerspectiveCamera(verticalFov_deg, 1, 0.02, 200);
  private readonly controls: OrbitControls;
  private readonly eye = new Vector3();
  private readonly target = new Vector3();
  private free = wholeImage; // of the image
  private readonly middle = new Vector2(); // of that part, where what is looked at is now
  private mode: 'framing' | 'free' | 'following' = 'framing';
  private framing: Framing | null = null;
  private placed = false;
  private pivoting = false;
  private inModel = false; // it looks as somebody has looked at the model before
  private ticking = false;

  constructor(
    canvas: HTMLCanvasElement,
    private readonly changed: () => void,
    private readonly touched: () => void,
  ) {
    this.camera.up.set(0, -1, 0);
    this.camera.position.set(0, -0.6, -1.6);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.minDistance = 0.05;
    this.controls.maxDistance = 100;
    this.controls.target.set(0, 0, 1);
    this.controls.listenToKeyEvents(canvas);
    this.controls.addEventListener('change', () => {
      if (!this.ticking) this.changed();
    });
    this.controls.addEventListener('start', () => this.release());
    canvas.addEventListener('keydown', (event) => this.onKey(event));
    this.controls.update();
  }

  get verticalFov_rad(): number {
    return (this.camera.fov * Math.PI) / 180;
  }

  resize(aspect: number): void {
    this.camera.aspect = aspect;
    showInMiddle(this.camera, this.middle);
    this.camera.updateProjectionMatrix();
    this.aim();
  }

  // Panels cover the rest of the image.
  setFreePart(free: FreePart): void {
    this.free = free;
    this.aim();
    this.changed();
  }

  // New content: only moves the eye while it frames the scan by itself.
  setFraming(framing: Framing): void {
    this.framing = framing;
    // What is larger than a scan, as a street that was imported, is seen as a whole, too.
    this.controls.maxDistance = Math.max(100, 8 * framing.radius_m);
    this.camera.far = Math.max(200, 16 * framing.radius_m);
    this.camera.near = this.camera.far / 10_000;
    this.camera.updateProjectionMatrix();
    this.aim();
  }

  frameAll(): void {
    this.mode = 'framing';
    this.aim();
  }

  follow(on: boolean): void {
    if (on) this.mode = 'following';
    else if (this.mode === 'following') this.mode = 'free';
    this.changed();
  }

  // The eye, and the point that it looks at.
  get view(): [Vector3, Vector3] {
    return [this.camera.position.clone(), this.controls.target.clone()];
  }

  // All turns around that point from now on; it comes to the middle of the image.
  pivot(point: Vector3): void {
    this.goTo(this.camera.position.clone().sub(this.controls.target).add(point), point);
  }

  // From there to that point, which are places in the model.
  lookFrom(eye: Vector3, target: Vector3): void {
    this.goTo(eye, target);
    this.inModel = true;
  }

  private goTo(eye: Vector3, target: Vector3): void {
    this.release();
    this.target.copy(target);
    this.eye.copy(eye);
    this.pivoting = true;
    this.changed();
  }

  // The world was turned about its origin: a view that somebody has chosen stays on what it shows,
  // and from where it does if that is a place in the model. Others are told where to look.
  carry(delta: Quaternion): void {
    if (this.mode !== 'free') return;
    if (this.inModel) {
      for (const point of [this.controls.target, this.target, this.camera.position, this.eye])
        point.applyQuaternion(delta);
      return;
    }
    const offset = new Vector3().subVectors(this.camera.position, this.controls.target);
    for (const point of [this.controls.target, this.target]) point.applyQuaternion(delta);
    this.camera.position.copy(this.controls.target).add(offset);
    this.eye.copy(this.target).add(offset);
  }

  // How the eye still moves after this.
  tick(elapsed_ms: number, scanner: GlidingPose, { upright, still }: Surroundings): EyeMotion {
    if (this.mode === 'following' && scanner.known) {
      for (const [at, offset_m] of [
        [this.eye, behind_m],
        [this.target, ahead_m],
      ] as const)
        at.copy(offset_m)
          .applyQuaternion(scanner.rotation)
          .add(scanner.translation)
          .applyQuaternion(upright);
      this.placed = true;
    }
    const goes = this.pivoting || (this.mode !== 'free' && this.placed);
    const glides = goes && this.glide(still ? Infinity : elapsed_ms);
    if (!glides) this.pivoting = false;
    const byItself = this.slide(still || !this.placed ? Infinity : elapsed_ms) || glides;
    // The controls report their own update as a change, which is no reason to draw once more.
    this.ticking = true;
    const changed = this.controls.update(elapsed_ms / 1000);
    this.ticking = false;
    return { byHand: changed && !byItself, byItself };
  }

  dispose(): void {
    this.controls.dispose();
  }

  private aim(): void {
    if (this.mode !== 'framing' || !this.framing) return;
    const { free, framing } = this;
    const freeFov_rad = 2 * Math.atan(Math.tan(this.verticalFov_rad / 2) * free.height);
    const distance_m =
      fittingDistance_m(
        framing.radius_m,
        freeFov_rad,
        (this.camera.aspect * free.width) / free.height,
      ) * sphereShare;
    this.target.fromArray(framing.center_m);
    if (free === wholeImage) this.target.y += lift * framing.radius_m;
    this.eye.copy(fromDirection).multiplyScalar(distance_m).add(this.target);
    if (!this.placed) {
      this.camera.position.copy(this.eye);
      this.controls.target.copy(this.target);
      this.placed = true;
    }
    this.changed();
  }

  private glide(elapsed_ms: number): boolean {
    const remaining_m = Math.max(
      this.camera.position.distanceTo(this.eye),
      this.controls.target.distanceTo(this.target),
    );
    if (remaining_m < 1e-3) return false;
    const share = 1 - Math.exp(-elapsed_ms / settle_ms);
    this.camera.position.lerp(this.eye, share);
    this.controls.target.lerp(this.target, share);
    return true;
  }

  // To the middle of the free part; false: it is there.
  private slide(elapsed_ms: number): boolean {
    const { middle, free } = this;
    if (middle.x === free.x && middle.y === free.y) return false;
    const remaining = Math.hypot(free.x - middle.x, free.y - middle.y);
    const share = 1 - Math.exp(-elapsed_ms / settle_ms);
    if (remaining < 1e-3 || share === 1) middle.set(free.x, free.y);
    else middle.set(middle.x + share * (free.x - middle.x), middle.y + share * (free.y - middle.y));
    showInMiddle(this.camera, middle);
    return true;
  }

  // The hand on the view always wins.
  private release(): void {
    this.pivoting = this.inModel = false;
    if (this.mode === 'free') return;
    this.mode = 'free';
    this.touched();
  }

  private onKey(event: KeyboardEvent): void {
    if (event.key.startsWith('Arrow')) this.release();
    const zoom = event.key === '+' ? 0.85 : event.key === '-' ? 1 / 0.85 : 0;
    if (zoom === 0) return;
    this.release();
    this.camera.position.sub(this.controls.target).multiplyScalar(zoom).add(this.controls.target);
    this.changed();
  }
}
