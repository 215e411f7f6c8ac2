import { describe, expect, it } from 'vitest';
import { frustumLines } from './frustum_layer';

const camera = { width: 4, height: 2, fx: 2, fy: 2, cx: 1.5, cy: 0.5 };

function points(lines: Float32Array): [number, number, number][] {
  return Array.from({ length: lines.length / 3 }, (_, i) => [lines[3 * i]!, lines[3 * i + 1]!, lines[3 * i + 2]!]);
}

describe('frustumLines', () => {
  it('spans the outer borders of the corner pixels', () => {
    const corners = points(frustumLines(camera, 1)).slice(0, 16);
    expect(Math.min(...corners.map((p) => p[0]))).toBeCloseTo(-1);
    expect(Math.max(...corners.map((p) => p[0]))).toBeCloseTo(1);
    expect(Math.min(...corners.map((p) => p[1]))).toBeCloseTo(-0.5);
    expect(Math.max(...corners.map((p) => p[1]))).toBeCloseTo(0.5);
  });

  it.each([2, -2])('has its roof on the upper side (fy %d)', (fy) => {
    const roof = points(frustumLines({ ...camera, fy }, 1)).slice(16);
    for (const point of roof) expect(point[1]).toBeLessThan(-0.4); // y points down
  });
});
