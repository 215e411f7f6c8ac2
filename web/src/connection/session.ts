// One scan watched over one WebSocket after another: hello, messages in order, acknowledgements
// after decoding, heartbeat, reconnection with jittered backoff. Knows no DOM; sockets and time
// come in from outside so that tests can hold them.
import { backoffDelay_ms } from './backoff';
import { DracoError } from './draco_instance';
import type { ChunkPoints, MeshPiece, ScanEvent, Watch } from './events';
import {
  ackBytes,
  decode,
  helloBytes,
  pingBytes,
  watchBytes,
  WireError,
  type WireChunk,
  type WireMeshChunk,
} from './wire';

export const subprotocol = 'hermite.v1';
export const pingEvery_ms = 15_000;
export const silenceLimit_ms = 45_000;
export const ackEvery_bytes = 64 * 1024;
export const pendingLimit_bytes = 64 * 1024 * 1024;

// Answers that will not change by asking again.
const finalErrorCodes = new Set(['unauthorized', 'not_found', 'unsupported', 'invalid_argument']);
const finalCloseCodes = new Map([
  [4001, 'unauthorized'],
  [4003, 'unauthorized'],
  [4004, 'not_found'],
]);

export type Socket = Pick<
  WebSocket,
  'send' | 'close' | 'binaryType' | 'onopen' | 'onmessage' | 'onclose'
>;

export interface SessionWorld {
  openSocket(url: string, protocol: string): Socket;
  decodeChunk(draco: Uint8Array, pointCount: number, level: number): Promise<ChunkPoints>;
  decodePiece(draco: Uint8Array, triangleCount: number): Promise<MeshPiece>;
  emit(event: ScanEvent): void;
  after(delay_ms: number, action: () => void): () => void; // returns how to cancel it
  now_ms(): number;
  random(): number; // [0, 1)
}

export interface SessionTarget {
  readonly url: string;
  readonly scanId: string;
  readonly token: string;
  readonly watch: Watch; // to begin with
}

// Everything that belongs to one socket and must not outlive it.
interface Connection {
  readonly socket: Socket;
  receivedBytes: number;
  handledBytes: number;
  acknowledgedBytes: number;
  heardAt_ms: number;
  open: boolean;
  complete: boolean; // finished and the snapshot is here: nothing more will come
  snapshotEnded: boolean;
  finalError: { code: string; message: string } | null;
  work: Promise<void>;
  cancelHeartbeat: () => void;
}

export class ScanSession {
  private failures = 0;
  private connection: Connection | null = null;
  private cancelRetry: () => void = () => {};
  private pingId = 0;
  private wanted: Watch;

  constructor(
    private readonly target: SessionTarget,
    private readonly world: SessionWorld,
  ) {
    this.wanted = target.watch;
  }

  // What to see from now on.
  watch(wanted: Watch): void {
    this.wanted = wanted;
    if (this.connection?.open) this.connection.socket.send(watchBytes(wanted));
  }

  start(): void {
    this.world.emit({ kind: 'connecting', attempt: this.failures + 1 });
    const socket = this.world.openSocket(this.target.url, subprotocol);
    const connection: Connection = {
      socket,
      receivedBytes: 0,
      handledBytes: 0,
      acknowledgedBytes: 0,
      heardAt_ms: this.world.now_ms(),
      open: false,
      complete: false,
      snapshotEnded: false,
      finalError: null,
      work: Promise.resolve(),
      cancelHeartbeat: () => {},
    };
    this.connection = connection;
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      connection.open = true;
      socket.send(helloBytes(this.target.scanId, this.target.token, this.wanted));
    };
    socket.onmessage = (message: MessageEvent) => this.receive(connection, message.data);
    socket.onclose = (event: CloseEvent) => {
      connection.cancelHeartbeat();
      connection.open = false;
      // What arrived before is shown first.
      void connection.work.then(() => this.closed(connection, event.code, event.reason));
    };
    this.scheduleHeartbeat(connection);
  }

  stop(): void {
    this.cancelRetry();
    const connection = this.connection;
    this.connection = null;
    connection?.cancelHeartbeat();
    connection?.socket.close(1000);
  }

  private receive(connection: Connection, data: unknown): void {
    if (connection !== this.connection || !(data instanceof ArrayBuffer)) return;
    connection.heardAt_ms = this.world.now_ms();
    connection.receivedBytes += data.byteLength;
    if (connection.receivedBytes - connection.handledBytes > pendingLimit_bytes) {
      connection.socket.close(4008, 'more than 64 MiB wait to be decoded');
      return;
    }
    const came_ms = connection.heardAt_ms;
    connection.work = connection.work.then(() =>
      this.handle(connection, new Uint8Array(data), came_ms),
    );
  }

  // One message after the other, never rejects.
  private async handle(connection: Connection, bytes: Uint8Array, came_ms: number): Promise<void> {
    if (connection !== this.connection) return;
    try {
      const incoming = decode(bytes);
      if (incoming.kind === 'wireChunk') await this.handleChunk(connection, incoming, came_ms);
      else if (incoming.kind === 'wireMeshChunk')
        await this.handleMeshChunk(connection, incoming, came_ms);
      else if (incoming.kind !== 'pong' && incoming.kind !== 'unknown')
        this.handleEvent(connection, incoming);
    } catch (error) {
      if (!(error instanceof WireError)) throw error;
      this.world.emit({ kind: 'serverError', code: 'corrupt_data', message: error.message });
    }
    connection.handledBytes += bytes.length;
    this.acknowledge(connection);
  }

  private handleEvent(connection: Connection, event: ScanEvent): void {
    if (event.kind === 'welcome') this.failures = 0;
    if (event.kind === 'snapshotEnd') connection.snapshotEnded = true;
    if (event.kind === 'scanState')
      connection.complete = event.phase !== 'running' && event.phase !== 'unknown';
    if (event.kind === 'serverError' && finalErrorCodes.has(event.code))
      connection.finalError = event;
    this.world.emit(event);
  }

  private async handleChunk(
    connection: Connection,
    chunk: WireChunk,
    came_ms: number,
  ): Promise<void> {
    const { key, version, pointCount } = chunk;
    if (pointCount === 0) {
      this.world.emit({ kind: 'chunk', key, version, points: null });
      return;
    }
    try {
      const points = await this.world.decodeChunk(chunk.draco, pointCount, chunk.key.level);
      if (connection === this.connection)
        this.world.emit({
          kind: 'chunk',
          key,
          version,
          points,
          waited_ms: this.world.now_ms() - came_ms,
        });
    } catch (error) {
      if (!(error instanceof DracoError)) throw error;
      this.world.emit({ kind: 'chunkFailed', key, reason: error.message });
    }
  }

  private async handleMeshChunk(
    connection: Connection,
    chunk: WireMeshChunk,
    came_ms: number,
  ): Promise<void> {
    const { cube, version, submap, triangleCount } = chunk;
    try {
      const piece =
        triangleCount === 0 ? null : await this.world.decodePiece(chunk.draco, triangleCount);
      if (connection === this.connection)
        this.world.emit({
          kind: 'meshChunk',
          cube,
          version,
          submap,
          piece,
          waited_ms: this.world.now_ms() - came_ms,
        });
    } catch (error) {
      if (!(error instanceof DracoError)) throw error;
      this.world.emit({ kind: 'chunkFailed', key: cube, reason: error.message });
    }
  }

  // After decoding, not after receipt: this is the back-pressure that the browser's
  // WebSocket does not have.
  private acknowledge(connection: Connection): void {
    const idle = connection.handledBytes === connection.receivedBytes;
    const fresh_bytes = connection.handledBytes - connection.acknowledgedBytes;
    if (!connection.open || fresh_bytes === 0 || (!idle && fresh_bytes < ackEvery_bytes)) return;
    connection.acknowledgedBytes = connection.handledBytes;
    connection.socket.send(ackBytes(connection.handledBytes));
  }

  private scheduleHeartbeat(connection: Connection): void {
    connection.cancelHeartbeat = this.world.after(pingEvery_ms, () => {
      if (this.world.now_ms() - connection.heardAt_ms >= silenceLimit_ms) {
        // close() alone would wait for the silent peer's answer.
        connection.socket.onclose = null;
        connection.open = false;
        connection.socket.close(4000, 'silence');
        void connection.work.then(() =>
          this.closed(connection, 4000, 'the server has been silent for 45 s'),
        );
        return;
      }
      if (connection.open) connection.socket.send(pingBytes(++this.pingId));
      this.scheduleHeartbeat(connection);
    });
  }

  private closed(connection: Connection, code: number, reason: string): void {
    if (connection !== this.connection) return;
    this.connection = null;
    const finalCode = connection.finalError?.code ?? finalCloseCodes.get(code);
    if (finalCode !== undefined) {
      this.world.emit({
        kind: 'closed',
        code: finalCode,
        reason: connection.finalError?.message ?? reason,
      });
      return;
    }
    if (code === 1000 && connection.complete && connection.snapshotEnded) {
      this.world.emit({ kind: 'closed', code: 'complete', reason: '' });
      return;
    }
    ++this.failures;
    const retryIn_ms = backoffDelay_ms(this.failures, this.world.random());
    this.world.emit({ kind: 'waiting', retryIn_ms, reason: reason || 'the connection was cut' });
    this.cancelRetry = this.world.after(retryIn_ms, () => this.start());
  }
}
