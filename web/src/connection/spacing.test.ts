import { expect, test } from 'vitest';
import { radiiOf } from './spacing';

// A square of the plane z = 0 with one point each `step_m`, shaken by up to a quarter of that.
function plane(step_m: number, side: number): Float32Array {
  let seed = 7;
  const shake = (): number => (((seed = (seed * 16807) % 2147483647) / 2147483647) * 0.5 - 0.25) * step_m;
  const positions: number[] = [];
  for (let i = 0; i < side; ++i) for (let j = 0; j < side; ++j) positions.push(i * step_m + shake() - 0.1, j * step_m + shake(), 0);
  return Float32Array.from(positions);
}

// The share of the plane, away from its edge, that some disc covers.
function covered(positions_m: Float32Array, radii_m: Float32Array, extent_m: number): number {
  let [inside, all] = [0, 0];
  for (let u = 0.15; u < 0.85; u += 0.01)
    for (let v = 0.15; v < 0.85; v += 0.01) {
      ++all;
      for (let i = 0; i < radii_m.length; ++i) {
        if (Math.hypot(positions_m[3 * i]! + 0.1 - u * extent_m, positions_m[3 * i + 1]! - v * extent_m) > radii_m[i]!) continue;
        ++inside;
        break;
      }
    }
  return inside / all;
}

test.each([0.005, 0.008, 0.014, 0.018])('discs leave no gap in a plane with a point each %d m, and are no larger than they must be', (step_m) => {
  const positions_m = plane(step_m, 24);
  const radii_m = radiiOf(positions_m, 0);
  expect(covered(positions_m, radii_m, 24 * step_m)).toBeGreaterThan(0.998);
  const sorted = [...radii_m].sort((a, b) => a - b);
  expect(sorted[Math.floor(sorted.length / 2)]).toBeLessThan(Math.max(1.4 * step_m, 0.0045));
});

test('a chunk of a higher level has discs as many times larger', () => {
  const near = radiiOf(plane(0.006, 10), 0);
  const far = radiiOf(plane(0.006 * 8, 10), 3);
  expect(far[55]! / near[55]!).toBeCloseTo(8, 1);
});

test('a point that is alone has a disc of its own, and none at all is no trouble', () => {
  expect(radiiOf(Float32Array.of(1, 2, 3), 0)[0]).toBeCloseTo(0.02, 4);
  expect(radiiOf(new Float32Array(), 0)).toHaveLength(0);
});

test('many points in one place come to an end', () => {
  const radii_m = radiiOf(new Float32Array(3 * 3000).fill(0.5), 0);
  expect(radii_m[0]).toBeCloseTo(0.0025, 4);
});
