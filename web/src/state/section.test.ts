import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import type { Triple } from './axes';
import type { Plane } from './cutting';
import {
  clippedTo,
  extentOf,
  joined,
  lengthOf,
  placeOf,
  segmentsOf,
  type Surface,
} from './section';

const axes = { along: [1, 0, 0], up: [0, 0, 1] } as const;
const level = (at_m: number): Plane => ({ u: [1, 0, 0], v: [0, 1, 0], normal: [0, 0, 1], at_m });

// A box from the origin, its corners numbered by bits; two triangles a face.
function boxOf(x: number, y: number, z: number): Surface {
  const corners = Array.from({ length: 8 }, (_, i) => [
    i & 1 ? x : 0,
    i & 2 ? y : 0,
    i & 4 ? z : 0,
  ]);
  const faces = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
  ];
  return {
    positions_m: corners.flat(),
    index: faces.flatMap(([a, b, c, d]) => [a!, b!, c!, a!, c!, d!]),
  };
}

// Each triangle with corners of its own, as behind a seam of a texture.
function torn({ positions_m, index }: Surface): Surface {
  const corners = Array.from(index).flatMap((i) => [
    positions_m[3 * i]!,
    positions_m[3 * i + 1]!,
    positions_m[3 * i + 2]!,
  ]);
  return { positions_m: corners, index: Array.from(index, (_, i) => i) };
}

const triangle = (...corners: readonly Triple[]): Surface => ({
  positions_m: corners.flat(),
  index: corners.map((_, i) => i),
});

describe('segmentsOf', () => {
  it('gives the outline of a box as one closed line, torn along every edge or not', () => {
    for (const box of [boxOf(4, 3, 2.5), torn(boxOf(4, 3, 2.5))]) {
      const lines = joined(segmentsOf(box, level(1.2)));
      expect(lines).toHaveLength(1);
      expect(lines[0]!.closed).toBe(true);
      expect(lengthOf(lines)).toBeCloseTo(14, 9);
      expect(extentOf(lines)).toEqual([0, 0, 4, 3]);
    }
  });

  it('draws the outline of a face that lies in the plane, without the diagonal', () => {
    for (const at_m of [0, 2]) {
      const lines = joined(segmentsOf(boxOf(4, 3, 2), level(at_m)));
      expect(lines).toHaveLength(1);
      expect(lengthOf(lines)).toBeCloseTo(14, 9);
    }
    const sheet = triangle([0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0], [1, 1, 0], [0, 1, 0]);
    expect(lengthOf(joined(segmentsOf(sheet, level(0))))).toBeCloseTo(4, 9);
  });

  it('goes through vertices that lie on the plane', () => {
    // A corner is on the plane, and the side across is cut in the middle.
    const through = triangle([0, 0, 0], [2, 0, 1], [2, 0, -1]);
    expect(segmentsOf(through, level(0))).toEqual([0, 0, 2, 0]);
    // A triangle that only touches the plane is not cut.
    expect(segmentsOf(triangle([0, 0, 0], [2, 0, 1], [2, 0, 2]), level(0))).toEqual([]);
    // Two triangles share an edge that is on the plane.
    const edge = triangle([0, 0, 0], [2, 0, 0], [1, 1, 1], [0, 0, 0], [2, 0, 0], [1, 1, -1]);
    expect(segmentsOf(edge, level(0))).toEqual([0, 0, 2, 0]);
    // An octahedron with four of its corners on the plane.
    const ring: Triple[] = [
      [1, 0, 0],
      [0, 1, 0],
      [-1, 0, 0],
      [0, -1, 0],
    ];
    const octahedron = triangle(
      ...ring.flatMap((one, i) => [
        one,
        ring[(i + 1) % 4]!,
        [0, 0, 1] as const,
        one,
        ring[(i + 1) % 4]!,
        [0, 0, -1] as const,
      ]),
    );
    const lines = joined(segmentsOf(octahedron, level(0)));
    expect(lines).toHaveLength(1);
    expect(lengthOf(lines)).toBeCloseTo(4 * Math.SQRT2, 9);
  });

  it('is not troubled by triangles without an area, or without a place', () => {
    const bad: Triple[] = [
      [0, 0, -1],
      [0, 0, -1],
      [0, 0, 1],
      [0, 0, -1],
      [0, 0, 0],
      [0, 0, 1],
      [0, 0, 0],
      [1, 0, 0],
      [2, 0, 0],
      [0, 0, NaN],
      [1, 0, 1],
      [1, 0, -1],
    ];
    expect(segmentsOf(triangle(...bad), level(0))).toEqual([]);
  });

  it('is open where the surface ends', () => {
    const box = boxOf(4, 3, 2);
    // Without the wall at the far end of x.
    const open: Surface = { ...box, index: Array.from(box.index).slice(0, -6) };
    const lines = joined(segmentsOf(open, level(1)));
    expect(lines).toHaveLength(1);
    expect(lines[0]!.closed).toBe(false);
    expect(lengthOf(lines)).toBeCloseTo(11, 9);
  });

  it('is nothing beside the surface', () => {
    expect(segmentsOf(boxOf(1, 1, 1), level(1.1))).toEqual([]);
    expect(joined([])).toEqual([]);
  });

  it('has the length of a box on any plane across it, also far from the origin', () => {
    const plane: Plane = { u: [0.6, 0.8, 0], v: [0, 0, 1], normal: [0.8, -0.6, 0], at_m: 0 };
    const far: Triple = [80_000, 60_000, 30];
    const box = boxOf(3, 4, 2);
    const moved = {
      ...box,
      positions_m: Array.from(box.positions_m, (value, i) => value + far[i % 3]!),
    };
    const at_m = far[0] * 0.8 - far[1] * 0.6;
    expect(lengthOf(joined(segmentsOf(moved, { ...plane, at_m })))).toBeCloseTo(2 * (5 + 2), 6);
    fc.assert(
      fc.property(
        fc.double({ min: 0.001, max: 1.999, noNaN: true }),
        (height) => Math.abs(lengthOf(joined(segmentsOf(box, level(height)))) - 14) < 1e-6,
      ),
    );
  });
});

describe('joined', () => {
  it('ends lines where three meet', () => {
    const lines = joined([0, 0, 1, 0, 1, 0, 2, 0, 1, 0, 1, 1]);
    expect(lines).toHaveLength(3);
    expect(lengthOf(lines)).toBeCloseTo(3);
  });

  it('keeps every length, whatever the order of the segments', () => {
    fc.assert(
      fc.property(fc.shuffledSubarray([0, 1, 2, 3, 4, 5, 6, 7], { minLength: 8 }), (order) => {
        const corner = (i: number): number[] => [
          Math.cos((i * Math.PI) / 4),
          Math.sin((i * Math.PI) / 4),
        ];
        const lines = joined(
          order.flatMap((i) =>
            i % 2 ? [...corner(i), ...corner(i + 1)] : [...corner(i + 1), ...corner(i)],
          ),
        );
        return (
          lines.length === 1 &&
          lines[0]!.closed &&
          Math.abs(lengthOf(lines) - 16 * Math.sin(Math.PI / 8)) < 1e-9
        );
      }),
    );
  });
});

describe('clippedTo', () => {
  const box = { low_m: [1, 0, -10], high_m: [2, 5, 10] } as const; // along, up, across
  it('keeps what is inside, cut at its faces', () => {
    const outline = segmentsOf(boxOf(4, 3, 2), level(1));
    const lines = joined(clippedTo(outline, level(1), axes, box));
    expect(lines).toHaveLength(2);
    expect(lengthOf(lines)).toBeCloseTo(2, 9);
  });
  it('is nothing where the plane is outside', () => {
    expect(clippedTo(segmentsOf(boxOf(4, 3, 8), level(6)), level(6), axes, box)).toEqual([]);
  });
});

describe('placeOf', () => {
  it('is on the plane', () => {
    expect(placeOf([1, 2], level(3))).toEqual([1, 2, 3]);
  });
});
