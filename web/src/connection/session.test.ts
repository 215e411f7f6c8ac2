import { create, fromBinary, toBinary, type MessageInitShape } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';
import {
  ClientMessageSchema,
  ScanPhase,
  ServerMessageSchema,
  type ClientMessage,
} from '../gen/scan_pb';
import { DracoError } from './draco_instance';
import type { ChunkPoints, MeshPiece, ScanEvent } from './events';
import { pingEvery_ms, ScanSession, silenceLimit_ms, subprotocol, type Socket } from './session';

type Body = NonNullable<MessageInitShape<typeof ServerMessageSchema>['body']>;

// The browser's end of a WebSocket, with the network in the test's hands.
class HeldSocket implements Socket {
  binaryType: BinaryType = 'blob';
  onopen: Socket['onopen'] = null;
  onmessage: Socket['onmessage'] = null;
  onclose: Socket['onclose'] = null;
  readonly sent: ClientMessage['body'][] = [];
  receivedBytes = 0;
  closedWith: number | undefined;

  send(data: Parameters<Socket['send']>[0]): void {
    this.sent.push(fromBinary(ClientMessageSchema, data as Uint8Array).body);
  }
  close(code?: number): void {
    this.closedWith = code;
  }
  opens(): void {
    this.onopen!.call(this as never, {} as Event);
  }
  receives(body: Body): void {
    const bytes = toBinary(ServerMessageSchema, create(ServerMessageSchema, { body }));
    this.receivedBytes += bytes.length;
    this.onmessage!.call(
      this as never,
      {
        data: bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length),
      } as MessageEvent,
    );
  }
  isCut(code = 1006, reason = ''): void {
    this.onclose?.call(this as never, { code, reason } as CloseEvent);
  }
  acknowledged(): number {
    const acks = this.sent.filter((body) => body.case === 'viewerAck');
    return acks.length === 0 ? 0 : Number(acks[acks.length - 1]!.value.bytes);
  }
}

const onePoint: ChunkPoints = {
  count: 1,
  positions_m: new Float32Array(3),
  colors: new Uint8Array(4),
  normals: new Int8Array(4),
  radii_m: new Float32Array(1),
  min_m: [0, 0, 0],
  max_m: [0, 0, 0],
};

const onePiece: MeshPiece = {
  triangles: 1,
  index: new Uint32Array(3),
  positions_m: new Float32Array(9),
  normals: new Int8Array(12),
  colors: new Uint8Array(12),
  hasConfidences: true,
};

class World {
  readonly sockets: HeldSocket[] = [];
  readonly events: ScanEvent[] = [];
  readonly decodes: { resolve: (points: ChunkPoints) => void; reject: (error: Error) => void }[] =
    [];
  private readonly timers = new Set<{ at_ms: number; action: () => void }>();
  private time_ms = 0;
  readonly session = new ScanSession(
    {
      url: 'ws://host/api/v1/ws',
      scanId: 'scan1',
      token: 'secret',
      watch: { points: false, mesh: true },
    },
    {
      openSocket: (_, protocol) => {
        expect(protocol).toBe(subprotocol);
        this.sockets.push(new HeldSocket());
        return this.socket;
      },
      decodeChunk: () => new Promise((resolve, reject) => this.decodes.push({ resolve, reject })),
      decodePiece: (_, triangleCount) =>
        triangleCount === 2 ? Promise.reject(new DracoError('no')) : Promise.resolve(onePiece),
      emit: (event) => this.events.push(event),
      after: (delay_ms, action) => {
        const timer = { at_ms: this.time_ms + delay_ms, action };
        this.timers.add(timer);
        return () => this.timers.delete(timer);
      },
      now_ms: () => this.time_ms,
      random: () => 0.5,
    },
  );

  get socket(): HeldSocket {
    return this.sockets[this.sockets.length - 1]!;
  }
  get kinds(): string[] {
    return this.events.map((event) => event.kind);
  }

  async passes(duration_ms: number): Promise<void> {
    const end_ms = this.time_ms + duration_ms;
    for (;;) {
      const due = [...this.timers]
        .filter((timer) => timer.at_ms <= end_ms)
        .sort((a, b) => a.at_ms - b.at_ms)[0];
      if (!due) break;
      this.timers.delete(due);
      this.time_ms = due.at_ms;
      due.action();
      await settled();
    }
    this.time_ms = end_ms;
    await settled();
  }
}

const settled = (): Promise<void> => new Promise((resolve) => setTimeout(resolve));

async function welcomed(): Promise<World> {
  const world = new World();
  world.session.start();
  world.socket.opens();
  world.socket.receives({ case: 'welcome', value: { title: 'Room' } });
  await settled();
  return world;
}

const chunk = (version: bigint): Body => ({
  case: 'chunk',
  value: { key: {}, version, pointCount: 1, draco: new Uint8Array(100) },
});

describe('ScanSession', () => {
  it('says what it wants to see, again on every connection, and when that changes', async () => {
    const world = new World();
    world.session.start();
    world.socket.opens();
    const hello = world.socket.sent[0]!;
    expect(
      hello.case === 'hello' &&
        hello.value.role.case === 'viewScan' &&
        hello.value.role.value.watch,
    ).toMatchObject({
      points: false,
      mesh: true,
    });
    world.session.watch({ points: true, mesh: false });
    expect(world.socket.sent[1]).toMatchObject({
      case: 'watch',
      value: { points: true, mesh: false },
    });
    world.socket.isCut();
    await settled();
    await world.passes(60_000);
    world.socket.opens();
    const again = world.socket.sent[0]!;
    expect(
      again.case === 'hello' &&
        again.value.role.case === 'viewScan' &&
        again.value.role.value.watch,
    ).toMatchObject({
      points: true,
      mesh: false,
    });
  });

  it('passes pieces of the surface on, and says which cannot be decoded', async () => {
    const world = new World();
    world.session.start();
    world.socket.opens();
    for (const triangleCount of [1, 2, 0]) {
      world.socket.receives({
        case: 'meshChunk',
        value: {
          cube: { part: 0, x: triangleCount, y: 0, z: 0 },
          version: 1n,
          submap: 4,
          triangleCount,
          draco: new Uint8Array(3),
        },
      });
    }
    await settled();
    const cube = (x: number) => ({ part: 0, x, y: 0, z: 0 });
    expect(world.events.slice(1)).toEqual([
      { kind: 'meshChunk', cube: cube(1), version: 1n, submap: 4, piece: onePiece, waited_ms: 0 },
      { kind: 'chunkFailed', key: cube(2), reason: 'no' },
      { kind: 'meshChunk', cube: cube(0), version: 1n, submap: 4, piece: null, waited_ms: 0 },
    ]);
    expect(world.socket.acknowledged()).toBe(world.socket.receivedBytes);
  });

  it('says hello first, with the scan and the token', async () => {
    const world = await welcomed();
    expect(world.socket.binaryType).toBe('arraybuffer');
    expect(world.socket.sent[0]).toMatchObject({
      case: 'hello',
      value: { token: 'secret', role: { case: 'viewScan', value: { scanId: 'scan1' } } },
    });
    expect(world.kinds).toEqual(['connecting', 'welcome']);
  });

  it('acknowledges all bytes, but only what is decoded, and keeps the order', async () => {
    const world = await welcomed();
    const before = world.socket.receivedBytes;
    expect(world.socket.acknowledged()).toBe(before);
    world.socket.receives(chunk(1n));
    world.socket.receives({ case: 'snapshotEnd', value: {} });
    await settled();
    expect(world.socket.acknowledged()).toBe(before);
    expect(world.kinds).not.toContain('snapshotEnd');
    world.decodes[0]!.resolve(onePoint);
    await settled();
    expect(world.kinds.slice(2)).toEqual(['chunk', 'snapshotEnd']);
    expect(world.socket.acknowledged()).toBe(world.socket.receivedBytes);
  });

  it('reports a chunk that cannot be decoded and goes on', async () => {
    const world = await welcomed();
    world.socket.receives(chunk(1n));
    world.socket.receives(chunk(2n));
    await settled();
    world.decodes[0]!.reject(new DracoError('trapped'));
    await settled();
    world.decodes[1]!.resolve(onePoint);
    await settled();
    expect(world.kinds.slice(2)).toEqual(['chunkFailed', 'chunk']);
    expect(world.socket.acknowledged()).toBe(world.socket.receivedBytes);
  });

  it('reports a message that is wrong and goes on', async () => {
    const world = await welcomed();
    world.socket.receives({ case: 'chunk', value: { pointCount: 1 } });
    world.socket.receives({ case: 'snapshotEnd', value: {} });
    await settled();
    expect(world.kinds.slice(2)).toEqual(['serverError', 'snapshotEnd']);
  });

  it('reconnects after a growing delay and starts over after a welcome', async () => {
    const world = await welcomed();
    const delays: number[] = [];
    for (let failure = 0; failure < 4; ++failure) {
      world.socket.isCut();
      await settled();
      const waiting = world.events[world.events.length - 1]!;
      if (waiting.kind !== 'waiting') throw new Error(`got ${waiting.kind}`);
      delays.push(waiting.retryIn_ms);
      await world.passes(waiting.retryIn_ms);
    }
    expect(delays).toEqual([250, 500, 1000, 2000]);
    expect(world.sockets).toHaveLength(5);
    world.socket.opens();
    world.socket.receives({ case: 'welcome', value: {} });
    world.socket.isCut();
    await settled();
    expect(world.events[world.events.length - 1]).toMatchObject({
      kind: 'waiting',
      retryIn_ms: 250,
    });
  });

  it.each([
    ['a refused token', () => {}, 4001],
    [
      'a scan that does not exist',
      (socket: HeldSocket) =>
        socket.receives({ case: 'error', value: { code: 'not_found', message: 'no such scan' } }),
      1000,
    ],
  ])('does not ask again after %s', async (_, answer, code) => {
    const world = new World();
    world.session.start();
    world.socket.opens();
    answer(world.socket);
    world.socket.isCut(code);
    await settled();
    await world.passes(120_000);
    expect(world.sockets).toHaveLength(1);
    expect(world.kinds).toContain('closed');
  });

  it('is done when a finished scan is complete, but comes back after a restart', async () => {
    const world = await welcomed();
    world.socket.receives({ case: 'scanState', value: { phase: ScanPhase.FINISHED } });
    world.socket.receives({ case: 'snapshotEnd', value: {} });
    world.socket.isCut(1001);
    await settled();
    await world.passes(1000);
    expect(world.sockets).toHaveLength(2);
    world.socket.opens();
    world.socket.receives({ case: 'welcome', value: {} });
    world.socket.receives({ case: 'scanState', value: { phase: ScanPhase.FINISHED } });
    world.socket.receives({ case: 'snapshotEnd', value: {} });
    world.socket.isCut(1000);
    await world.passes(120_000);
    expect(world.sockets).toHaveLength(2);
    expect(world.events[world.events.length - 1]).toMatchObject({
      kind: 'closed',
      code: 'complete',
    });
  });

  it('gives a silent server up, not one that answers', async () => {
    const world = await welcomed();
    for (let i = 0; i < 8; ++i) {
      await world.passes(pingEvery_ms);
      world.socket.receives({ case: 'pong', value: {} });
      await settled();
    }
    expect(world.sockets).toHaveLength(1);
    await world.passes(silenceLimit_ms + pingEvery_ms);
    expect(world.sockets[0]!.closedWith).toBe(4000);
    expect(world.kinds).toContain('waiting');
    expect(world.sockets.length).toBeGreaterThan(1);
  });

  it('says nothing any more once it is stopped', async () => {
    const world = await welcomed();
    world.session.stop();
    const told = world.events.length;
    world.socket.receives({ case: 'snapshotEnd', value: {} });
    world.socket.isCut();
    await world.passes(120_000);
    expect(world.events).toHaveLength(told);
    expect(world.sockets).toHaveLength(1);
  });
});
