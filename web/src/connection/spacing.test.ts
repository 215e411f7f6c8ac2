import { expect, test } from 'vitest';
import { radiiOf } from './spacing';

// A square of the plane z = 0 with a point each `step_m` in rows that are `rows` times as far from
// each other, shaken by up to a quarter of that.
function plane(step_m: number, rows: number, side: number): Float32Array {
  let seed = 7;
  const shake = (): number =>
    (((seed = (seed * 16807) % 2147483647) / 2147483647) * 0.5 - 0.25) * step_m;
  const positions: number[] = [];
  for (let i = 0; i < side * rows; ++i)
    for (let j = 0; j < side; ++j)
      positions.push(i * step_m + shake() - 0.1, j * rows * step_m + shake(), 0);
  return Float32Array.from(positions);
}

function facing(positions_m: Float32Array, z = 127): Int8Array {
  return Int8Array.from({ length: (4 * positions_m.length) / 3 }, (_, i) => (i % 4 === 2 ? z : 0));
}

// The share of the plane, away from its edge, that some disc covers.
function covered(positions_m: Float32Array, radii_m: Float32Array, extent_m: number): number {
  let [inside, all] = [0, 0];
  for (let u = 0.2; u < 0.8; u += 0.015)
    for (let v = 0.2; v < 0.8; v += 0.015) {
      ++all;
      for (let i = 0; i < radii_m.length; ++i) {
        if (
          Math.hypot(
            positions_m[3 * i]! + 0.1 - u * extent_m,
            positions_m[3 * i + 1]! - v * extent_m,
          ) > radii_m[i]!
        )
          continue;
        ++inside;
        break;
      }
    }
  return inside / all;
}

test.each([
  [0.005, 1],
  [0.008, 1],
  [0.014, 1],
  [0.005, 2],
  [0.003, 4],
  [0.02, 1],
])(
  'discs just leave no gap in a plane with a point each %d m in rows %d times as far apart',
  (step_m, rows) => {
    const positions_m = plane(step_m, rows, 20);
    const radii_m = radiiOf(positions_m, facing(positions_m), 0);
    expect(covered(positions_m, radii_m, 20 * rows * step_m)).toBeGreaterThan(0.998);
    const sorted = [...radii_m].sort((a, b) => a - b);
    expect(sorted[Math.floor(sorted.length / 2)]).toBeLessThan(
      Math.max(1.3 * step_m * rows, 0.0045),
    );
  },
);

test.each([
  [0, 1, 2],
  [1, 2, 0],
  [2, 0, 1],
])('without normals discs leave no gap in a floor or a wall either: axes %d %d %d', (...axes) => {
  const positions_m = plane(0.008, 2, 20);
  const turned_m = positions_m.map((_, i) => positions_m[3 * Math.floor(i / 3) + axes[i % 3]!]!);
  const radii_m = radiiOf(turned_m, facing(positions_m, 0), 0);
  expect(covered(positions_m, radii_m, 20 * 2 * 0.008)).toBeGreaterThan(0.99);
});

test('another surface close behind is none of theirs', () => {
  const near = plane(0.005, 1, 20);
  const both = Float32Array.from([
    ...near,
    ...near.map((value, i) => (i % 3 === 2 ? 0.006 : value)),
  ]);
  const alone = radiiOf(near, facing(near), 0);
  const beside = radiiOf(both, facing(both), 0);
  for (let i = 0; i < alone.length; ++i) expect(beside[i]).toBeCloseTo(alone[i]!, 4);
});

test('a chunk of a higher level has larger discs, and one without normals has discs, too', () => {
  const near = plane(0.006, 1, 10);
  const far = near.map((value) => 8 * value);
  expect(radiiOf(far, facing(far), 3)[55]! / radiiOf(near, facing(near), 0)[55]!).toBeCloseTo(8, 1);
  expect(radiiOf(near, facing(near, 0), 0)[55]).toBeGreaterThan(0.004);
});

test('a point that is alone has a disc of its own, and none at all is no trouble', () => {
  expect(radiiOf(Float32Array.of(1, 2, 3), facing(new Float32Array(3)), 0)[0]).toBeCloseTo(0.03, 4);
  expect(radiiOf(new Float32Array(), new Int8Array(), 0)).toHaveLength(0);
});

test('many points in one place come to an end', () => {
  const positions_m = new Float32Array(3 * 3000).fill(0.5);
  expect(radiiOf(positions_m, facing(positions_m), 0)[0]).toBeCloseTo(0.0025, 4);
});
