// One WebAssembly instance of Draco's decoder, made when it is first needed and
// thrown away after a trap.
import createModule, {
  type DracoModule,
} from 'three/examples/jsm/libs/draco/draco_wasm_wrapper.js';

export class DracoError extends Error {}

// Not safe for overlapping calls; await one before the next.
export class DracoInstance {
  private module: Promise<DracoModule> | null = null;

  constructor(private readonly wasmBinary: ArrayBuffer) {}

  // Rejects with a DracoError with a message; the instance can be used again afterwards.
  async run<Decoded>(decode: (module: DracoModule) => Decoded): Promise<Decoded> {
    this.module ??= createModule({ wasmBinary: this.wasmBinary });
    const module = await this.module;
    try {
      return decode(module);
    } catch (error) {
      if (error instanceof DracoError) throw error;
      this.module = null; // a trap or an abort: the instance's memory can no longer be trusted
      throw new DracoError(`the Draco decoder gave up: ${(error as Error).message}`);
    }
  }
}
