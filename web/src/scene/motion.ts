// Poses that glide to where they belong instead of jumping.
import { Matrix4, Quaternion, Vector3 } from 'three';
import type { Pose } from '../connection/events';

const one = new Vector3(1, 1, 1);

function isAt(translation: Vector3, rotation: Quaternion, pose: Pose): boolean {
  const same = (have: readonly number[], told: readonly number[]): boolean =>
    have.every((value, i) => value === told[i]);
  return same(translation.toArray(), pose.translation) && same(rotation.toArray(), pose.rotation);
}

// a_from_c of a_from_b and b_from_c.
export function composed(aFromB: Pose, bFromC: Pose): Pose {
  const rotation = new Quaternion(...aFromB.rotation);
  const translation = new Vector3(...bFromC.translation)
    .applyQuaternion(rotation)
    .add(new Vector3(...aFromB.translation));
  rotation.multiply(new Quaternion(...bFromC.rotation));
  return {
    translation: translation.toArray(),
    rotation: [rotation.x, rotation.y, rotation.z, rotation.w],
  };
}

export class GlidingPose {
  readonly translation = new Vector3();
  readonly rotation = new Quaternion();
  private readonly fromTranslation = new Vector3();
  private readonly fromRotation = new Quaternion();
  private readonly toTranslation = new Vector3();
  private readonly toRotation = new Quaternion();
  private progress = 1;
  private placed = false;

  constructor(private readonly duration_ms: number) {}

  get known(): boolean {
    return this.placed;
  }

  // The first pose is taken at once. Where it goes already it need not be told again.
  moveTo(pose: Pose): void {
    if (this.placed && isAt(this.toTranslation, this.toRotation, pose)) return;
    this.toTranslation.fromArray(pose.translation);
    this.toRotation.fromArray(pose.rotation);
    this.fromTranslation.copy(this.placed ? this.translation : this.toTranslation);
    this.fromRotation.copy(this.placed ? this.rotation : this.toRotation);
    this.progress = 0;
    if (!this.placed) this.tick(this.duration_ms);
    this.placed = true;
  }

  // True while it moves.
  tick(elapsed_ms: number): boolean {
    if (this.progress >= 1) return false;
    this.progress = Math.min(1, this.progress + elapsed_ms / this.duration_ms);
    this.translation.lerpVectors(this.fromTranslation, this.toTranslation, this.progress);
    this.rotation.slerpQuaternions(this.fromRotation, this.toRotation, this.progress);
    return true;
  }

  matrix(target: Matrix4): Matrix4 {
    return target.compose(this.translation, this.rotation, one);
  }
}
