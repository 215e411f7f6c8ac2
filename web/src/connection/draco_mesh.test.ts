/// <reference types="node" />
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { DracoError } from './draco_instance';
import { DracoMeshDecoder, type WantedAttribute } from './draco_mesh';

const here = new URL('.', import.meta.url).pathname;
const wasm = readFileSync(
  `${here}/../../node_modules/three/examples/jsm/libs/draco/draco_decoder.wasm`,
);
// `hermite export FILE.ply --format glb-draco` of nine vertices and eight triangles: a shallow roof
// of 0.2 m, red, green and blue by rows.
const glb = readFileSync(`${here}/testdata/roof.glb`);

const decoder = (): DracoMeshDecoder =>
  new DracoMeshDecoder(
    wasm.buffer.slice(wasm.byteOffset, wasm.byteOffset + wasm.byteLength) as ArrayBuffer,
  );

// What GLTFLoader passes on.
function primitiveOf(file: Buffer): { draco: Uint8Array; wanted: WantedAttribute[] } {
  const jsonLength = file.readUInt32LE(12);
  const gltf = JSON.parse(file.subarray(20, 20 + jsonLength).toString());
  const extension = gltf.meshes[0].primitives[0].extensions.KHR_draco_mesh_compression;
  const view = gltf.bufferViews[extension.bufferView];
  const begin = 28 + jsonLength + (view.byteOffset ?? 0);
  const { POSITION, NORMAL, COLOR_0 } = extension.attributes;
  return {
    draco: new Uint8Array(file.subarray(begin, begin + view.byteLength)),
    wanted: [
      { name: 'position', uniqueId: POSITION, type: 'Float32Array' },
      { name: 'normal', uniqueId: NORMAL, type: 'Float32Array' },
      { name: 'color', uniqueId: COLOR_0, type: 'Uint16Array' },
    ],
  };
}

describe('DracoMeshDecoder', () => {
  const { draco, wanted } = primitiveOf(glb);

  it('reads what the server wrote: triangles, positions with y up, normals, colours', async () => {
    const mesh = await decoder().decode(draco, wanted);
    expect(mesh.index.length).toBe(3 * 8);
    const [position, normal, color] = mesh.attributes;
    expect(position!.itemSize).toBe(3);
    const vertices = position!.array.length / 3;
    expect(vertices).toBe(9);
    const corners = new Set(
      Array.from({ length: vertices }, (_, i) =>
        [0, 1, 2].map((axis) => Math.round(100 * position!.array[3 * i + axis]!) / 100 + 0).join(),
      ),
    );
    expect(corners).toContain('0.1,-0.1,-0.95'); // the ridge
    expect(corners).toContain('0.2,-0.2,-1');
    expect(normal!.array.length).toBe(3 * vertices);
    expect(normal!.array[2]).toBeGreaterThan(0.99); // to the eye, which looks along -z
    expect(color!.array.length).toBe(color!.itemSize * vertices);
    expect(Math.max(...color!.array)).toBeGreaterThan(65_000);
  });

  it('reads the same again, and after bytes that are none', async () => {
    const one = decoder();
    const first = await one.decode(draco, wanted);
    await expect(one.decode(new Uint8Array([1, 2, 3]), wanted)).rejects.toThrow(DracoError);
    await expect(one.decode(draco.subarray(0, draco.length / 2), wanted)).rejects.toThrow();
    expect((await one.decode(draco, wanted)).index).toEqual(first.index);
  });

  it('survives every single damaged byte and still reads good meshes', async () => {
    const one = decoder();
    for (let i = 0; i < draco.length; ++i) {
      const bytes = draco.slice();
      bytes[i]! ^= 0xff;
      await one
        .decode(bytes, wanted)
        .catch((error: unknown) => expect(error).toBeInstanceOf(DracoError));
    }
    expect((await one.decode(draco, wanted)).index.length).toBe(3 * 8);
  });

  it('refuses a mesh without a wanted attribute, and leaves out an optional one', async () => {
    const other = { name: 'other', uniqueId: 77, type: 'Uint8Array' } as const;
    await expect(decoder().decode(draco, [...wanted, other])).rejects.toThrow(
      'attribute other is missing',
    );
    const mesh = await decoder().decode(draco, [{ ...other, optional: true }, ...wanted]);
    expect(mesh.attributes.map(({ name }) => name)).toEqual(wanted.map(({ name }) => name));
  });

  it('takes a cloud for no mesh', async () => {
    const cloud = new Uint8Array(readFileSync(`${here}/testdata/sphere_chunk.drc`));
    await expect(decoder().decode(cloud, wanted)).rejects.toThrow('not a Draco mesh');
  });
});
