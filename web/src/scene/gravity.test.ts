import { Quaternion, Vector3 } from 'three';
import { expect, test } from 'vitest';
import { bestUp, floorHeight_m, upOf, upRange, type SurfaceSamples } from './gravity';

interface Patch {
  readonly normal: readonly [number, number, number]; // where up is -y
  readonly at_m: number; // along the normal
  readonly count: number;
}

// A room as a camera sees it that is turned by `tilt`, with noise on the normals.
function room(patches: readonly Patch[], tilt: Quaternion, noise = 0.05): SurfaceSamples {
  let seed = 1;
  const random = (): number => (seed = (seed * 16807) % 2147483647) / 2147483647 - 0.5;
  const positions: number[] = [];
  const normals: number[] = [];
  for (const { normal, at_m, count } of patches)
    for (let i = 0; i < count; ++i) {
      const n = new Vector3(...normal);
      const across = new Vector3(random(), random(), random()).multiplyScalar(4).projectOnPlane(n);
      positions.push(...across.addScaledVector(n, at_m).applyQuaternion(tilt).toArray());
      normals.push(
        ...n
          .add(new Vector3(random(), random(), random()).multiplyScalar(2 * noise))
          .normalize()
          .applyQuaternion(tilt)
          .toArray(),
      );
    }
  const count = positions.length / 3;
  return {
    count,
    positions_m: Float32Array.from(positions),
    normals: Float32Array.from(normals),
    weights: new Float32Array(count).fill(1),
  };
}

const tilted = (x_deg: number, z_deg: number): Quaternion =>
  new Quaternion()
    .setFromAxisAngle(new Vector3(1, 0, 0), (x_deg * Math.PI) / 180)
    .multiply(new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), (z_deg * Math.PI) / 180));

const floor: Patch = { normal: [0, -1, 0], at_m: -1.4, count: 400 };
const table: Patch = { normal: [0, -1, 0], at_m: -0.7, count: 500 };
const walls: readonly Patch[] = [
  { normal: [0, 0, -1], at_m: -3, count: 1500 },
  { normal: [1, 0, 0], at_m: -2, count: 900 },
];

const off_deg = (up: readonly [number, number, number] | null, tilt: Quaternion): number =>
  (new Vector3(...up!).angleTo(new Vector3(0, -1, 0).applyQuaternion(tilt)) * 180) / Math.PI;

const direction = (tilt: Quaternion): [number, number, number] =>
  new Vector3(0, -1, 0).applyQuaternion(tilt).toArray();

test.each([
  [0, 0],
  [33, 0],
  [-25, 20],
  [40, -30],
])('up is found in a room whose first camera was tilted by %d and %d degrees', (x_deg, z_deg) => {
  const tilt = tilted(x_deg, z_deg);
  expect(off_deg(upOf(room([floor, table, ...walls], tilt)), tilt)).toBeLessThan(0.7);
});

test('a floor alone says it, and so do walls with a little of a floor', () => {
  const tilt = tilted(30, 5);
  expect(off_deg(upOf(room([{ ...floor, count: 3000 }], tilt)), tilt)).toBeLessThan(0.7);
  expect(off_deg(upOf(room([{ ...floor, count: 150 }, ...walls], tilt)), tilt)).toBeLessThan(1);
});

test('a camera on its side finds up by what its accelerometer measured', () => {
  const tilt = tilted(10, 90);
  const samples = room([floor, table, ...walls], tilt);
  const measured = { inWorld: direction(tilted(13, 90)), sigma_rad: 0.03 };
  expect(upOf(samples) === null || off_deg(upOf(samples), tilt) > 60).toBe(true);
  expect(off_deg(upOf(samples, upRange(measured)), tilt)).toBeLessThan(0.7);
  expect(off_deg(bestUp(samples, measured), tilt)).toBeLessThan(0.7);
});

test('what was measured holds where the surface says nothing, or something else', () => {
  const tilt = tilted(0, 0);
  const measured = { inWorld: direction(tilted(20, 0)), sigma_rad: 0.02 };
  expect(bestUp(room([{ ...floor, count: 100 }], tilt), measured)).toEqual(measured.inWorld);
  expect(bestUp(room([{ ...floor, count: 3000 }], tilt), measured)).toEqual(measured.inWorld);
  expect(bestUp(room([{ ...floor, count: 100 }], tilt), null)).toBeNull();
});

test('a sphere has no up, and nor have a few points', () => {
  const samples = room([{ normal: [1, 0, 0], at_m: 1, count: 2000 }], new Quaternion(), 40);
  expect(upOf(samples)).toBeNull();
  expect(upOf(room([{ ...floor, count: 100 }], new Quaternion()))).toBeNull();
});

test('the floor is the lowest large layer, below tables and above clutter', () => {
  const up = [0, -1, 0] as const;
  const height_m = floorHeight_m(
    room([floor, table, { ...floor, at_m: -2.5, count: 20 }, ...walls], new Quaternion()),
    up,
  );
  expect(height_m).toBeGreaterThan(-1.43);
  expect(height_m).toBeLessThan(-1.37);
  expect(floorHeight_m(room(walls, new Quaternion()), up)).toBeNull();
});
