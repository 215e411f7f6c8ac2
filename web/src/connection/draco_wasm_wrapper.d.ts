// The part of Emscripten's Draco decoder that we call; three ships the script without types.
declare module 'three/examples/jsm/libs/draco/draco_wasm_wrapper.js' {
  export interface DracoStatus {
    ok(): boolean;
    error_msg(): string;
  }
  export interface DracoCloud {
    num_points(): number;
  }
  export interface DracoAttribute {
    num_components(): number;
  }
  export interface DracoBuffer {
    Init(data: Int8Array, size: number): void;
  }
  export interface DracoDecoder {
    DecodeBufferToPointCloud(buffer: DracoBuffer, cloud: DracoCloud): DracoStatus;
    GetAttributeId(cloud: DracoCloud, type: number): number;
    GetAttribute(cloud: DracoCloud, id: number): DracoAttribute;
    GetAttributeDataArrayForAllPoints(
      cloud: DracoCloud,
      attribute: DracoAttribute,
      type: number,
      bytes: number,
      pointer: number,
    ): boolean;
  }
  export interface DracoMesh {
    num_points(): number;
    num_faces(): number;
  }
  export interface MeshDecoder {
    DecodeBufferToMesh(buffer: DracoBuffer, mesh: DracoMesh): DracoStatus;
    GetAttributeByUniqueId(mesh: DracoMesh, id: number): DracoAttribute;
    GetTrianglesUInt32Array(mesh: DracoMesh, bytes: number, pointer: number): boolean;
    GetAttributeDataArrayForAllPoints(
      mesh: DracoMesh,
      attribute: DracoAttribute,
      type: number,
      bytes: number,
      pointer: number,
    ): boolean;
  }
  export interface DracoModule {
    readonly POSITION: number;
    readonly NORMAL: number;
    readonly COLOR: number;
    readonly GENERIC: number;
    readonly DT_FLOAT32: number;
    readonly DT_INT8: number;
    readonly DT_INT16: number;
    readonly DT_UINT8: number;
    readonly DT_UINT16: number;
    readonly DT_UINT32: number;
    readonly HEAPU8: Uint8Array;
    Decoder: new () => DracoDecoder & MeshDecoder;
    DecoderBuffer: new () => DracoBuffer;
    PointCloud: new () => DracoCloud;
    Mesh: new () => DracoMesh;
    destroy(object: unknown): void;
    getPointer(object: unknown): number; // 0: there is no such object
    _malloc(bytes: number): number;
    _free(pointer: number): void;
  }
  const createModule: (options: { wasmBinary: ArrayBuffer }) => Promise<DracoModule>;
  export default createModule;
}
