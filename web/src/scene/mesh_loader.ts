// A GLB of the server -> three's objects. three's GLTFLoader reads it; Draco is decoded by a worker
// of our own, because three's makes its worker out of a text, which the page's
// Content-Security-Policy forbids.
import { BufferAttribute, BufferGeometry, Mesh, type Object3D } from 'three';
import type { DRACOLoader } from 'three/examples/jsm/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import type { ArrayTypeName, DecodedMesh, WantedAttribute } from '../connection/draco_mesh';
import type { MeshAnswer, MeshOrder } from '../connection/mesh_worker';

export class MeshError extends Error {}

// Rejects with a MeshError with a message. The root's frame is glTF's: metres, y up.
export async function loadMesh(bytes: ArrayBuffer): Promise<Object3D> {
  const decoder = new WorkerDecoder();
  try {
    const loader = new GLTFLoader();
    loader.setDRACOLoader(decoder as unknown as DRACOLoader);
    const { scene } = await loader.parseAsync(bytes, '');
    let triangles = 0;
    scene.traverse((object) => {
      if (object instanceof Mesh)
        triangles +=
          (object.geometry.index?.count ?? object.geometry.getAttribute('position').count) / 3;
    });
    if (triangles === 0) throw new MeshError('the mesh has no triangles');
    return scene;
  } catch (error) {
    throw error instanceof MeshError ? error : new MeshError((error as Error).message);
  } finally {
    decoder.dispose();
  }
}

interface Waiting {
  readonly resolve: (mesh: DecodedMesh) => void;
  readonly reject: (error: Error) => void;
}

// What GLTFLoader asks of three's DRACOLoader.
class WorkerDecoder {
  private worker: Worker | null = null;
  private readonly waiting = new Map<number, Waiting>();
  private next = 0;

  preload(): this {
    return this;
  }

  decodeDracoFile(
    bytes: ArrayBuffer,
    onLoad: (geometry: BufferGeometry) => void,
    uniqueIds: Readonly<Record<string, number>>,
    types: Readonly<Record<string, ArrayTypeName>>,
    _colorSpace: string,
    onError: (error: Error) => void,
  ): void {
    const wanted = Object.entries(uniqueIds).map(([name, uniqueId]) => ({
      name,
      uniqueId,
      type: types[name]!,
    }));
    this.decode(bytes, wanted).then((mesh) => onLoad(geometryOf(mesh)), onError);
  }

  dispose(): void {
    this.worker?.terminate();
    for (const { reject } of this.waiting.values()) reject(new MeshError('the decoder was ended'));
    this.waiting.clear();
  }

  private decode(bytes: ArrayBuffer, wanted: readonly WantedAttribute[]): Promise<DecodedMesh> {
    this.worker ??= this.start();
    return new Promise((resolve, reject) => {
      const order: MeshOrder = { id: this.next++, bytes: bytes.slice(0), wanted };
      this.waiting.set(order.id, { resolve, reject });
      this.worker!.postMessage(order, [order.bytes]);
    });
  }

  private start(): Worker {
    const worker = new Worker(new URL('../connection/mesh_worker.ts', import.meta.url), {
      type: 'module',
    });
    worker.onmessage = ({ data }: MessageEvent<MeshAnswer>) => {
      const waiting = this.waiting.get(data.id);
      this.waiting.delete(data.id);
      if ('mesh' in data) waiting?.resolve(data.mesh);
      else waiting?.reject(new MeshError(data.message));
    };
    worker.onerror = (event) => {
      event.preventDefault();
      for (const { reject } of this.waiting.values())
        reject(new MeshError(event.message || 'the decoder could not be started'));
      this.waiting.clear();
    };
    return worker;
  }
}

function geometryOf({ index, attributes }: DecodedMesh): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(index, 1));
  for (const { name, array, itemSize } of attributes)
    geometry.setAttribute(name, new BufferAttribute(array, itemSize));
  return geometry;
}
