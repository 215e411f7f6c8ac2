// The Web Worker: owns the socket and the Draco decoder, so that neither parsing nor
// decoding ever stops the image.
/// <reference lib="webworker" />
import wasmUrl from 'three/examples/jsm/libs/draco/draco_decoder.wasm?url';
import { DracoDecoder } from './draco';
import { DracoMeshDecoder } from './draco_mesh';
import type { FromWorker, ScanEvent, ToWorker, Watch } from './events';
import { decodePiece } from './mesh_piece';
import { ScanSession, type SessionTarget } from './session';

declare const self: DedicatedWorkerGlobalScope;

function post(message: FromWorker, transfer: Transferable[] = []): void {
  self.postMessage(message, transfer);
}

function emit(event: ScanEvent): void {
  if (event.kind === 'chunk' && event.points) {
    const { positions_m, colors, normals, radii_m } = event.points;
    post({ kind: 'event', event }, [
      positions_m.buffer,
      colors.buffer,
      normals.buffer,
      radii_m.buffer,
    ]);
  } else if (event.kind === 'meshChunk' && event.piece) {
    const { index, positions_m, normals, colors } = event.piece;
    post({ kind: 'event', event }, [
      index.buffer,
      positions_m.buffer,
      normals.buffer,
      colors.buffer,
    ]);
  } else {
    post({ kind: 'event', event });
  }
}

let session: ScanSession | null = null;
let wanted: Watch | null = null; // since it was opened

async function open(target: SessionTarget): Promise<void> {
  const response = await fetch(wasmUrl, { signal: AbortSignal.timeout(30_000) });
  if (!response.ok)
    throw new Error(`the Draco decoder could not be loaded: HTTP ${response.status}`);
  const wasm = await response.arrayBuffer();
  const decoder = new DracoDecoder(wasm);
  const meshDecoder = new DracoMeshDecoder(wasm);
  session = new ScanSession(
    { ...target, watch: wanted ?? target.watch },
    {
      openSocket: (url, protocol) => new WebSocket(url, protocol),
      decodeChunk: (draco, pointCount, level) => decoder.decode(draco, pointCount, level),
      decodePiece: (draco, triangleCount) => decodePiece(meshDecoder, draco, triangleCount),
      emit,
      after: (delay_ms, action) => {
        const timer = setTimeout(action, delay_ms);
        return () => clearTimeout(timer);
      },
      now_ms: () => performance.now(),
      random: Math.random,
    },
  );
  session.start();
}

self.onmessage = (message: MessageEvent<ToWorker>) => {
  const order = message.data;
  if (order.kind === 'alive?') post({ kind: 'alive' });
  else if (order.kind === 'watch') {
    wanted = order.watch;
    session?.watch(wanted);
  } else
    void open(order).catch((error: unknown) => {
      // An error event is what tells the page to start another worker.
      setTimeout(() => {
        throw error;
      });
    });
};
