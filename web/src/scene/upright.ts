// Turns the world so that up is up: by itself from the surface, or as somebody has said. Everything
// of the world hangs below `object`; outside of it y points down along gravity.
import { Group, Quaternion, Vector3 } from 'three';
import type { Box } from './framing';
import type { MeasuredUp } from '../connection/events';
import { bestUp, firstCamerasUp, type Direction, type SurfaceSamples } from './gravity';

const settle_ms = 300; // time constant of the turn
const estimateEvery_ms = 2_500; // while the scan grows
const worthATurn_rad = 0.03; // less would only make the image restless
const down = new Vector3(0, -1, 0);

export class Upright {
  readonly object = new Group(); // viewFromWorld, a rotation
  private readonly target = new Quaternion();
  private chosen: Direction | null = null;
  private found: Direction = firstCamerasUp;
  private measured: MeasuredUp | null = null;
  private estimated_ms = -Infinity;
  private still = true;

  // `onTurned`: after every step, by how much.
  constructor(private readonly onTurned: (delta: Quaternion) => void) {
    this.object.matrixAutoUpdate = false;
  }

  get up(): Direction {
    return this.chosen ?? this.found;
  }

  // What somebody has said; null: it is to be found again.
  choose(up: Direction | null): void {
    this.chosen = up;
    this.aim();
  }

  // Another model of which nothing is known: the first camera's up, as what is imported has it.
  forget(): void {
    this.found = firstCamerasUp;
    this.measured = null;
    this.aim();
  }

  // What the camera's accelerometer says, for the estimates from now on.
  measure(measured: MeasuredUp | null): void {
    this.measured = measured;
  }

  isDue(now_ms: number): boolean {
    return now_ms - this.estimated_ms >= estimateEvery_ms;
  }

  // True when up is another one now. `final`: nothing more will come, so that
  // small changes count, too.
  estimate(samples: SurfaceSamples, now_ms: number, final: boolean): boolean {
    this.estimated_ms = now_ms;
    const up = bestUp(samples, this.measured);
    if (!up) return false;
    const off_rad = new Vector3(...up).angleTo(new Vector3(...this.found));
    if (off_rad < (final ? 1e-3 : worthATurn_rad)) return false;
    this.found = up;
    this.aim();
    return this.chosen === null;
  }

  // True while it turns. `at_once`: for those who do not like motion.
  tick(elapsed_ms: number, at_once: boolean): boolean {
    if (this.still) return false;
    const before = this.object.quaternion.clone();
    const left_rad = before.angleTo(this.target);
    this.still = left_rad < 1e-4 || at_once;
    this.object.quaternion.slerp(
      this.target,
      this.still ? 1 : 1 - Math.exp(-elapsed_ms / settle_ms),
    );
    this.object.updateMatrix();
    this.object.matrixWorldNeedsUpdate = true;
    this.onTurned(this.object.quaternion.clone().multiply(before.invert()));
    return !this.still;
  }

  // About the same box where up is up: its middle turns, and it stays as large as it is.
  turned({ min_m, max_m, weight }: Box): Box {
    const low = new Vector3(...min_m);
    const half = new Vector3(...max_m).sub(low).multiplyScalar(0.5);
    const middle = low.add(half).applyQuaternion(this.object.quaternion);
    return {
      min_m: middle.clone().sub(half).toArray(),
      max_m: middle.clone().add(half).toArray(),
      weight,
    };
  }

  private aim(): void {
    this.target.setFromUnitVectors(new Vector3(...this.up), down);
    this.still = false;
  }
}
