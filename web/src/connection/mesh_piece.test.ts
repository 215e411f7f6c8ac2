/// <reference types="node" />
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { DracoError } from './draco_instance';
import { DracoMeshDecoder } from './draco_mesh';
import { decodePiece } from './mesh_piece';

const here = new URL('.', import.meta.url).pathname;
const wasm = readFileSync(
  `${here}/../../node_modules/three/examples/jsm/libs/draco/draco_decoder.wasm`,
);
// tests/core/output/mesh_chunk_test.cpp writes it: a strip of 40 triangles,
// red by its place along x.
const strip = new Uint8Array(readFileSync(`${here}/testdata/mesh_piece.drc`));
// The same, with a confidence of the same number as its red.
const seen = new Uint8Array(readFileSync(`${here}/testdata/mesh_piece_with_confidence.drc`));

const decoder = (): DracoMeshDecoder =>
  new DracoMeshDecoder(
    wasm.buffer.slice(wasm.byteOffset, wasm.byteOffset + wasm.byteLength) as ArrayBuffer,
  );

describe('decodePiece', () => {
  it('reads what the server wrote', async () => {
    const piece = await decodePiece(decoder(), strip, 40);
    expect(piece.index.length).toBe(120);
    expect(piece.positions_m.length).toBe(3 * 42);
    for (let i = 0; i < 42; ++i) {
      const column = Math.round((piece.positions_m[3 * i]! - 0.001) / 0.016);
      expect([...piece.colors.subarray(4 * i, 4 * i + 4)]).toEqual([column, 20, 30, 255]);
      expect(piece.normals[4 * i + 2]).toBeGreaterThan(120);
    }
  });

  it('reads how well each place was seen, where the server says so', async () => {
    const [older, newer] = [
      await decodePiece(decoder(), strip, 40),
      await decodePiece(decoder(), seen, 40),
    ];
    expect([older.hasConfidences, newer.hasConfidences]).toEqual([false, true]);
    for (let i = 0; i < 42; ++i) expect(newer.colors[4 * i + 3]).toBe(8 * newer.colors[4 * i]!);
    const blind = {
      ...newer,
      hasConfidences: false,
      colors: newer.colors.map((value, i) => (i % 4 === 3 ? 255 : value)),
    };
    expect(blind).toEqual(older);
  });

  it('refuses another count than was declared, and what is no mesh', async () => {
    await expect(decodePiece(decoder(), strip, 41)).rejects.toThrow(DracoError);
    await expect(decodePiece(decoder(), strip.subarray(0, 60), 40)).rejects.toThrow(DracoError);
    await expect(decodePiece(decoder(), Uint8Array.of(1, 2, 3), 1)).rejects.toThrow(DracoError);
  });
});
