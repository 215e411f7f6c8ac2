// Draco bytes -> points, with bounds. The bytes come from our own server, but a decoder is never
// trusted with more than it needs: the header is read first, the count must be the declared one,
// and after a trap the whole WebAssembly instance is thrown away.
import type {
  DracoAttribute,
  DracoCloud,
  DracoDecoder as Decoder,
  DracoModule,
} from 'three/examples/jsm/libs/draco/draco_wasm_wrapper.js';
import { DracoError, DracoInstance } from './draco_instance';
import type { ChunkPoints } from './events';
import { radiiOf } from './spacing';
import { maxPointsPerChunk } from './wire';

// Not safe for overlapping calls; await one before the next.
export class DracoDecoder {
  private readonly draco: DracoInstance;

  constructor(wasmBinary: ArrayBuffer) {
    this.draco = new DracoInstance(wasmBinary);
  }

  // Rejects with a DracoError with a message; the decoder can be used again afterwards.
  async decode(bytes: Uint8Array, declaredCount: number, level: number): Promise<ChunkPoints> {
    checkHeader(bytes, declaredCount);
    return this.draco.run((module) => {
      const points = decodeCloud(module, bytes, declaredCount);
      return { ...points, radii_m: radiiOf(points.positions_m, points.normals, level) };
    });
  }
}

// 'DRACO', version 2 bytes, geometry type, method, flags 2 bytes, then (sequential
// method) the point count.
function checkHeader(bytes: Uint8Array, declaredCount: number): void {
  if (declaredCount < 1 || declaredCount > maxPointsPerChunk) {
    throw new DracoError(`${declaredCount} points declared, the limit is ${maxPointsPerChunk}`);
  }
  if (bytes.length < 15)
    throw new DracoError(`${bytes.length} bytes are too short for a Draco point cloud`);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const magic = String.fromCharCode(...bytes.subarray(0, 5));
  if (magic !== 'DRACO') throw new DracoError('the bytes are not Draco');
  if (view.getUint8(7) !== 0 || view.getUint8(8) !== 0 || view.getUint16(9, true) !== 0) {
    throw new DracoError('not a sequentially encoded Draco point cloud');
  }
  const count = view.getUint32(11, true);
  if (count !== declaredCount)
    throw new DracoError(`the Draco header says ${count} points, the chunk ${declaredCount}`);
}

// New objects for every chunk: reusing a Decoder makes it read out of bounds
// (google/draco issue 656).
function decodeCloud(
  module: DracoModule,
  bytes: Uint8Array,
  declaredCount: number,
): Omit<ChunkPoints, 'radii_m'> {
  const decoder = new module.Decoder();
  const buffer = new module.DecoderBuffer();
  const cloud = new module.PointCloud();
  try {
    buffer.Init(new Int8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength), bytes.byteLength);
    const status = decoder.DecodeBufferToPointCloud(buffer, cloud);
    if (!status.ok()) throw new DracoError(`Draco: ${status.error_msg()}`);
    if (cloud.num_points() !== declaredCount)
      throw new DracoError(`${cloud.num_points()} points decoded, ${declaredCount} declared`);
    return readPoints({ module, decoder, cloud, count: declaredCount });
  } finally {
    module.destroy(cloud);
    module.destroy(buffer);
    module.destroy(decoder);
  }
}

interface Decoded {
  readonly module: DracoModule;
  readonly decoder: Decoder;
  readonly cloud: DracoCloud;
  readonly count: number;
}

function readPoints(decoded: Decoded): Omit<ChunkPoints, 'radii_m'> {
  const { module, count } = decoded;
  const positions = readFloats(decoded, module.POSITION);
  if (!positions) throw new DracoError('the chunk has no POSITION attribute');
  const positions_m = positions;
  const rgb = readBytes(decoded, module.COLOR, 3);
  const normalFloats = readFloats(decoded, module.NORMAL);
  const confidence = readBytes(decoded, module.GENERIC, 1);
  const colors = new Uint8Array(count * 4).fill(255);
  const normals = new Int8Array(count * 4);
  for (let i = 0; i < count; ++i) {
    if (rgb) colors.set(rgb.subarray(i * 3, i * 3 + 3), i * 4);
    colors[i * 4 + 3] = confidence ? confidence[i]! : 255;
    if (normalFloats)
      for (let axis = 0; axis < 3; ++axis)
        normals[i * 4 + axis] = Math.round(normalFloats[i * 3 + axis]! * 127);
  }
  return { count, positions_m, colors, normals, ...boundsOf(positions_m) };
}

function readFloats(decoded: Decoded, type: number): Float32Array | null {
  const bytes = readAttribute(decoded, {
    type,
    dataType: decoded.module.DT_FLOAT32,
    components: 3,
    componentBytes: 4,
  });
  return bytes && new Float32Array(bytes.buffer);
}

function readBytes(decoded: Decoded, type: number, components: number): Uint8Array | null {
  return readAttribute(decoded, {
    type,
    dataType: decoded.module.DT_UINT8,
    components,
    componentBytes: 1,
  });
}

interface Wanted {
  readonly type: number;
  readonly dataType: number;
  readonly components: number;
  readonly componentBytes: number;
}

// A copy of the attribute for all points, null when the cloud has none.
function readAttribute(decoded: Decoded, wanted: Wanted): Uint8Array<ArrayBuffer> | null {
  const { module, decoder, cloud, count } = decoded;
  const id = decoder.GetAttributeId(cloud, wanted.type);
  if (id < 0) return null;
  const attribute: DracoAttribute = decoder.GetAttribute(cloud, id);
  const components = attribute.num_components();
  if (components !== wanted.components) {
    throw new DracoError(
      `attribute ${wanted.type} has ${components} components, not ${wanted.components}`,
    );
  }
  const size_bytes = count * wanted.components * wanted.componentBytes;
  const pointer = module._malloc(size_bytes);
  try {
    if (
      !decoder.GetAttributeDataArrayForAllPoints(
        cloud,
        attribute,
        wanted.dataType,
        size_bytes,
        pointer,
      )
    ) {
      throw new DracoError(`attribute ${wanted.type} cannot be read`);
    }
    // HEAPU8 is looked up after the call, in which the heap may have moved.
    return module.HEAPU8.slice(pointer, pointer + size_bytes) as Uint8Array<ArrayBuffer>;
  } finally {
    module._free(pointer);
  }
}

function boundsOf(positions_m: Float32Array): Pick<ChunkPoints, 'min_m' | 'max_m'> {
  const min_m: [number, number, number] = [Infinity, Infinity, Infinity];
  const max_m: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions_m.length; ++i) {
    const value = positions_m[i]!;
    if (!Number.isFinite(value)) throw new DracoError('a position is not finite');
    const axis = (i % 3) as 0 | 1 | 2;
    if (value < min_m[axis]) min_m[axis] = value;
    if (value > max_m[axis]) max_m[axis] = value;
  }
  return { min_m, max_m };
}
