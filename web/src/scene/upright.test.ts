import { Quaternion, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import type { SurfaceSamples } from './gravity';
import { Upright } from './upright';

// A floor that is seen by a camera which looks down by an angle.
function floor(tilt_rad: number): SurfaceSamples {
  const count = 1000;
  const normals = Float32Array.from(
    { length: 3 * count },
    (_, i) => [0, -Math.cos(tilt_rad), -Math.sin(tilt_rad)][i % 3]!,
  );
  return {
    count,
    positions_m: new Float32Array(3 * count),
    normals,
    weights: new Float32Array(count).fill(1),
  };
}

const turn = (upright: Upright): void => {
  for (let i = 0; i < 100; ++i) upright.tick(100, false);
};
// Where the floor's normal points on the screen.
const shown = (upright: Upright, tilt_rad: number): Vector3 =>
  new Vector3(0, -Math.cos(tilt_rad), -Math.sin(tilt_rad)).applyQuaternion(
    upright.object.quaternion,
  );

describe('Upright', () => {
  it('turns the world so that the floor lies flat, and tells how far', () => {
    const turned = new Quaternion();
    const upright = new Upright((delta) => turned.premultiply(delta));
    expect(upright.estimate(floor(0.6), 0, false)).toBe(true);
    expect(upright.tick(100, false)).toBe(true);
    turn(upright);
    expect(shown(upright, 0.6).y).toBeCloseTo(-1, 5);
    expect(upright.tick(100, false)).toBe(false);
    expect(turned.angleTo(upright.object.quaternion)).toBeLessThan(1e-5);
  });

  it('does not stir for little while the scan grows, and does at its end', () => {
    const upright = new Upright(() => {});
    upright.estimate(floor(0.6), 0, false);
    expect(upright.estimate(floor(0.62), 1, false)).toBe(false);
    expect(upright.estimate(floor(0.62), 2, true)).toBe(true);
  });

  it('does what somebody has said until it is taken back', () => {
    const upright = new Upright(() => {});
    upright.choose([0, -Math.cos(0.3), -Math.sin(0.3)]);
    expect(upright.estimate(floor(0.6), 0, true)).toBe(false);
    upright.tick(1, true); // at once
    expect(shown(upright, 0.3).y).toBeCloseTo(-1, 5);
    upright.choose(null);
    turn(upright);
    expect(shown(upright, 0.6).y).toBeCloseTo(-1, 5);
  });

  it('is where the accelerometer says it, however the camera was held', () => {
    const upright = new Upright(() => {});
    upright.measure({ inWorld: [0, Math.cos(0.3), Math.sin(0.3)], sigma_rad: 0.02 });
    expect(upright.estimate(floor(0.6), 0, false)).toBe(true);
    turn(upright);
    expect(shown(upright, 0.3).y).toBeCloseTo(1, 5);
    upright.forget(); // another model
    upright.estimate(floor(0.6), 1, true);
    turn(upright);
    expect(shown(upright, 0.6).y).toBeCloseTo(-1, 5);
  });

  it('leaves what nobody has scanned as it is', () => {
    const upright = new Upright(() => {});
    upright.estimate(floor(0.6), 0, true);
    upright.forget();
    turn(upright);
    expect(upright.object.quaternion.angleTo(new Quaternion())).toBeLessThan(1e-4);
  });
});
