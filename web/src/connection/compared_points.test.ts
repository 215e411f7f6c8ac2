import { describe, expect, it } from 'vitest';
import { readComparedPoints } from './compared_points';

interface Row {
  readonly at: readonly [number, number, number];
  readonly normal?: readonly [number, number, number];
  readonly distance?: number;
  readonly state?: number;
  readonly scan?: number;
  readonly region?: number;
}

const columns = [
  ...['x', 'y', 'z', 'nx', 'ny', 'nz'].map((name) => `float ${name}`),
  ...['red', 'green', 'blue'].map((name) => `uchar ${name}`),
  'float distance',
  'float sigma',
  'uchar state',
  'uchar scan',
  'int region',
];

function ply(rows: readonly Row[], names = columns, count = rows.length): ArrayBuffer {
  const properties = names.map((name) => `property ${name}\n`).join('');
  const header = new TextEncoder().encode(
    'ply\nformat binary_little_endian 1.0\ncomment a test\n' +
      `element vertex ${count}\n${properties}end_header\n`,
  );
  const bytes = new ArrayBuffer(header.length + 41 * rows.length);
  new Uint8Array(bytes).set(header);
  const view = new DataView(bytes);
  rows.forEach(
    ({ at, normal = [0, 0, -1], distance = NaN, state = 1, scan = 0, region = -1 }, i) => {
      const begin = header.length + 41 * i;
      [...at, ...normal].forEach((value, axis) => view.setFloat32(begin + 4 * axis, value, true));
      [200, 100, 50].forEach((value, channel) => view.setUint8(begin + 24 + channel, value));
      view.setFloat32(begin + 27, distance, true);
      view.setFloat32(begin + 31, 0.001, true);
      view.setUint8(begin + 35, state);
      view.setUint8(begin + 36, scan);
      view.setInt32(begin + 37, region, true);
    },
  );
  return bytes;
}

describe('the points of a comparison', () => {
  it('are cut into cubes of each scan, with what has become of each', () => {
    const { chunks, regions } = readComparedPoints(
      ply([
        { at: [0.1, 0.1, 0.1], distance: 0.02, state: 2, region: 3 },
        { at: [0.2, 0.1, 0.1], distance: 0.02, state: 2, region: 3 },
        { at: [-0.1, 0.1, 0.1] },
        { at: [0.1, 0.1, 0.1], scan: 1, state: 0 },
      ]),
    );
    expect(chunks.map(({ scan, cube, points }) => [scan, ...cube, points.count])).toEqual([
      [0, 0, 0, 0, 2],
      [0, -1, 0, 0, 1],
      [1, 0, 0, 0, 1],
    ]);
    const [first] = chunks;
    expect([...first!.points.colors.slice(0, 4)]).toEqual([200, 100, 50, 255]);
    expect([...first!.points.normals.slice(0, 3)]).toEqual([0, 0, -127]);
    expect([...first!.states]).toEqual([2, 2]);
    expect(first!.distances_m[0]).toBeCloseTo(0.02);
    expect(first!.points.radii_m[0]).toBeGreaterThan(0);
    expect(first!.points.max_m[0]).toBeCloseTo(0.2);
    expect(chunks[2]!.distances_m[0]).toBeNaN();
    expect(regions.size).toBe(1);
    expect(regions.get(3)!.middle_m[0]).toBeCloseTo(0.15);
    expect(regions.get(3)!.normal).toEqual([0, 0, -1]);
  });
  it('may be none', () => {
    expect(readComparedPoints(ply([])).chunks).toEqual([]);
  });
  it('are refused when they are not what they say', () => {
    const one = [{ at: [0, 0, 0] as const }];
    expect(() => readComparedPoints(new ArrayBuffer(0))).toThrow('not the points of a comparison');
    expect(() => readComparedPoints(ply(one, columns.slice(0, -1)))).toThrow('no column region');
    expect(() =>
      readComparedPoints(
        ply(
          one,
          columns.map((name) => name.replace('uchar state', 'float state')),
        ),
      ),
    ).toThrow('no column state');
    expect(() => readComparedPoints(ply(one, columns, 2))).toThrow('2 points do not fit');
    expect(() => readComparedPoints(ply(one, columns, 999_999_999))).toThrow('allowed are up to');
    expect(() => readComparedPoints(ply([{ at: [NaN, 0, 0] }]))).toThrow('not finite');
  });
});
