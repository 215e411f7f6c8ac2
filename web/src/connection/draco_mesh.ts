// Draco bytes of a glTF primitive -> arrays, with bounds. As in draco.ts a decoder is not
// trusted with more than it needs: the header is read first, and after a trap the whole
// WebAssembly instance is thrown away. The layout is glTF's KHR_draco_mesh_compression:
// attributes by their unique ids.
import type {
  DracoModule,
  DracoMesh,
  MeshDecoder,
} from 'three/examples/jsm/libs/draco/draco_wasm_wrapper.js';
import { DracoError, DracoInstance } from './draco_instance';

export const maxMeshValues = 64_000_000; // of one array: 20 million vertices in three floats

export const arrayTypes = {
  Float32Array,
  Int8Array,
  Int16Array,
  Uint8Array,
  Uint16Array,
  Uint32Array,
} as const;
export type ArrayTypeName = keyof typeof arrayTypes;
export type MeshArray = InstanceType<(typeof arrayTypes)[ArrayTypeName]>;

export interface WantedAttribute {
  readonly name: string;
  readonly uniqueId: number;
  readonly type: ArrayTypeName;
  readonly optional?: boolean; // where it is missing, it is left out of what is decoded
}

export interface DecodedMesh {
  readonly index: Uint32Array;
  readonly attributes: readonly {
    readonly name: string;
    readonly array: MeshArray;
    readonly itemSize: number;
  }[];
}

// Not safe for overlapping calls; await one before the next.
export class DracoMeshDecoder {
  private readonly draco: DracoInstance;

  constructor(wasmBinary: ArrayBuffer) {
    this.draco = new DracoInstance(wasmBinary);
  }

  // Rejects with a DracoError with a message; the decoder can be used again afterwards.
  async decode(bytes: Uint8Array, wanted: readonly WantedAttribute[]): Promise<DecodedMesh> {
    checkHeader(bytes);
    return this.draco.run((module) => decodeMesh(module, bytes, wanted));
  }
}

// 'DRACO', version 2 bytes, geometry type: 1 is a mesh.
function checkHeader(bytes: Uint8Array): void {
  if (bytes.length < 11 || String.fromCharCode(...bytes.subarray(0, 5)) !== 'DRACO')
    throw new DracoError('the bytes are not Draco');
  if (bytes[7] !== 1) throw new DracoError('the bytes are not a Draco mesh');
}

function decodeMesh(
  module: DracoModule,
  bytes: Uint8Array,
  wanted: readonly WantedAttribute[],
): DecodedMesh {
  const decoder: MeshDecoder = new module.Decoder();
  const buffer = new module.DecoderBuffer();
  const mesh = new module.Mesh();
  try {
    buffer.Init(new Int8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength), bytes.byteLength);
    const status = decoder.DecodeBufferToMesh(buffer, mesh);
    if (!status.ok()) throw new DracoError(`Draco: ${status.error_msg()}`);
    return {
      index: readIndex(module, decoder, mesh),
      attributes: wanted.flatMap((one) => readAttribute(module, decoder, mesh, one) ?? []),
    };
  } finally {
    module.destroy(mesh);
    module.destroy(buffer);
    module.destroy(decoder);
  }
}

function readIndex(module: DracoModule, decoder: MeshDecoder, mesh: DracoMesh): Uint32Array {
  const count = 3 * mesh.num_faces();
  const index = new Uint32Array(
    copied(module, count, 4, (size_bytes, at) =>
      decoder.GetTrianglesUInt32Array(mesh, size_bytes, at),
    ),
  );
  const vertices = mesh.num_points();
  for (const vertex of index)
    if (vertex >= vertices)
      throw new DracoError(`a triangle names vertex ${vertex} of ${vertices}`);
  return index;
}

function readAttribute(
  module: DracoModule,
  decoder: MeshDecoder,
  mesh: DracoMesh,
  wanted: WantedAttribute,
): DecodedMesh['attributes'][number] | null {
  const attribute = decoder.GetAttributeByUniqueId(mesh, wanted.uniqueId);
  if (module.getPointer(attribute) === 0) {
    if (wanted.optional) return null;
    throw new DracoError(`attribute ${wanted.name} is missing`);
  }
  const itemSize = attribute.num_components();
  if (itemSize < 1 || itemSize > 4)
    throw new DracoError(`attribute ${wanted.name} has ${itemSize} components`);
  const type = arrayTypes[wanted.type];
  const dataType = {
    Float32Array: module.DT_FLOAT32,
    Int8Array: module.DT_INT8,
    Int16Array: module.DT_INT16,
    Uint8Array: module.DT_UINT8,
    Uint16Array: module.DT_UINT16,
    Uint32Array: module.DT_UINT32,
  }[wanted.type];
  const bytes = copied(
    module,
    mesh.num_points() * itemSize,
    type.BYTES_PER_ELEMENT,
    (size_bytes, at) =>
      decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, dataType, size_bytes, at),
  );
  return { name: wanted.name, array: new type(bytes), itemSize };
}

// What `read` writes into the decoder's memory.
function copied(
  module: DracoModule,
  count: number,
  element_bytes: number,
  read: (size_bytes: number, at: number) => boolean,
): ArrayBuffer {
  if (count < 1 || count > maxMeshValues)
    throw new DracoError(`${count} values in an array, the limit is ${maxMeshValues}`);
  const size_bytes = count * element_bytes;
  const at = module._malloc(size_bytes);
  try {
    if (!read(size_bytes, at)) throw new DracoError('an array of the mesh cannot be read');
    // HEAPU8 is looked up after the call, in which the heap may have moved.
    return (module.HEAPU8 as Uint8Array<ArrayBuffer>).slice(at, at + size_bytes).buffer;
  } finally {
    module._free(at);
  }
}
