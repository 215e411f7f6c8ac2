/// <reference types="node" />
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { DracoDecoder } from './draco';
import { DracoError } from './draco_instance';

const here = new URL('.', import.meta.url).pathname;
const wasm = readFileSync(
  `${here}/../../node_modules/three/examples/jsm/libs/draco/draco_decoder.wasm`,
);
// The file is made by tests/core/output/golden_chunk_test.cpp.
const golden = new Uint8Array(readFileSync(`${here}/testdata/sphere_chunk.drc`));
const goldenCount = 500;
const chunkEdge_m = 0.32;
const halfStep_m = chunkEdge_m / 512 / 2;

const decoder = (): DracoDecoder =>
  new DracoDecoder(
    wasm.buffer.slice(wasm.byteOffset, wasm.byteOffset + wasm.byteLength) as ArrayBuffer,
  );
const changed = (index: number, value: number): Uint8Array => {
  const bytes = golden.slice();
  bytes[index] = value;
  return bytes;
};

describe('DracoDecoder', () => {
  it('reads what the server encoded: positions, colours, normals and confidences', async () => {
    const points = await decoder().decode(golden, goldenCount, 0);
    expect(points.count).toBe(goldenCount);
    for (let i = 0; i < goldenCount; ++i) {
      const position = [...points.positions_m.subarray(3 * i, 3 * i + 3)];
      const fromCenter = position.map((value) => value - chunkEdge_m / 2);
      const radius_m = Math.hypot(...fromCenter);
      expect(Math.abs(radius_m - 0.1)).toBeLessThan(2 * halfStep_m);
      for (let axis = 0; axis < 3; ++axis) {
        expect(
          Math.abs(points.colors[4 * i + axis]! - (255 * position[axis]!) / chunkEdge_m),
        ).toBeLessThan(1.01);
        expect(
          Math.abs(points.normals[4 * i + axis]! / 127 - fromCenter[axis]! / 0.1),
        ).toBeLessThan(0.03);
      }
      expect(
        Math.abs(points.colors[4 * i + 3]! - (8 * 20 * position[2]!) / chunkEdge_m),
      ).toBeLessThan(1.01);
    }
    for (let axis = 0; axis < 3; ++axis) {
      expect(points.min_m[axis]).toBeCloseTo(0.06, 2);
      expect(points.max_m[axis]).toBeCloseTo(0.26, 2);
    }
  });

  it('reads the same chunk again and again', async () => {
    const shared = decoder();
    const first = await shared.decode(golden, goldenCount, 0);
    for (let i = 0; i < 20; ++i)
      expect((await shared.decode(golden, goldenCount, 0)).positions_m).toEqual(first.positions_m);
  });

  it.each([
    ['nothing', new Uint8Array(), 1],
    ['something else', new TextEncoder().encode('not a Draco stream at all'), 1],
    ['a mesh', changed(7, 1), goldenCount],
    ['a kd-tree', changed(8, 1), goldenCount],
    ['another count than declared', golden, goldenCount - 1],
    ['a count beyond the limit', golden, 262145],
    ['a header that promises more points than declared', changed(13, 200), goldenCount],
    ['half a chunk', golden.subarray(0, golden.length / 2), goldenCount],
  ])('refuses %s', async (_, bytes, count) => {
    await expect(decoder().decode(bytes, count, 0)).rejects.toBeInstanceOf(DracoError);
  });

  it('survives every single damaged byte and still reads good chunks', async () => {
    const shared = decoder();
    for (let index = 0; index < golden.length; index += 7) {
      for (const value of [0, 255, golden[index]! ^ 0x55]) {
        try {
          const points = await shared.decode(changed(index, value), goldenCount, 0);
          expect(points.count).toBe(goldenCount);
        } catch (error) {
          expect(error).toBeInstanceOf(DracoError);
        }
      }
    }
    expect((await shared.decode(golden, goldenCount, 0)).count).toBe(goldenCount);
  }, 60_000);
});
