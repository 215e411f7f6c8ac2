// The Web Worker that decodes meshes: the image goes on meanwhile.
/// <reference lib="webworker" />
import wasmUrl from 'three/examples/jsm/libs/draco/draco_decoder.wasm?url';
import { DracoMeshDecoder, type DecodedMesh, type WantedAttribute } from './draco_mesh';

declare const self: DedicatedWorkerGlobalScope;

export interface MeshOrder {
  readonly id: number;
  readonly bytes: ArrayBuffer;
  readonly wanted: readonly WantedAttribute[];
}

export type MeshAnswer =
  | { readonly id: number; readonly mesh: DecodedMesh }
  | { readonly id: number; readonly message: string };

let decoder: Promise<DracoMeshDecoder> | null = null;
let last: Promise<void> = Promise.resolve();

async function load(): Promise<DracoMeshDecoder> {
  const response = await fetch(wasmUrl, { signal: AbortSignal.timeout(30_000) });
  if (!response.ok)
    throw new Error(`the Draco decoder could not be loaded: HTTP ${response.status}`);
  return new DracoMeshDecoder(await response.arrayBuffer());
}

async function answer({ id, bytes, wanted }: MeshOrder): Promise<void> {
  try {
    decoder ??= load();
    const mesh = await (await decoder).decode(new Uint8Array(bytes), wanted);
    self.postMessage({ id, mesh } satisfies MeshAnswer, [
      mesh.index.buffer as ArrayBuffer,
      ...mesh.attributes.map(({ array }) => array.buffer as ArrayBuffer),
    ]);
  } catch (error) {
    decoder = null;
    self.postMessage({ id, message: (error as Error).message } satisfies MeshAnswer);
  }
}

// One after the other.
self.onmessage = (message: MessageEvent<MeshOrder>) => {
  last = last.then(() => answer(message.data));
};
