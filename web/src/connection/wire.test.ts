import { create, fromBinary, toBinary, type MessageInitShape } from '@bufbuild/protobuf';
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import {
  ClientMessageSchema,
  MapEvent,
  ScanPhase,
  ServerMessageSchema,
  TrackingStatus,
} from '../gen/scan_pb';
import {
  ackBytes,
  decode,
  helloBytes,
  maxPointsPerChunk,
  maxTrianglesPerChunk,
  pingBytes,
  watchBytes,
  WireError,
} from './wire';

type Body = NonNullable<MessageInitShape<typeof ServerMessageSchema>['body']>;
const serverBytes = (body: Body): Uint8Array =>
  toBinary(ServerMessageSchema, create(ServerMessageSchema, { body }));
const identity = { tx: 1, ty: 2, tz: 3, qx: 0, qy: 0, qz: 0, qw: 2 };

describe('what the viewer sends', () => {
  it('says hello with the scan and the token', () => {
    const body = fromBinary(
      ClientMessageSchema,
      helloBytes('scan1', 'secret', { points: false, mesh: true }),
    ).body;
    expect(body).toMatchObject({
      case: 'hello',
      value: {
        token: 'secret',
        role: {
          case: 'viewScan',
          value: { scanId: 'scan1', watch: { points: false, mesh: true } },
        },
      },
    });
  });

  it('says what it wants to see', () => {
    expect(
      fromBinary(ClientMessageSchema, watchBytes({ points: true, mesh: false })).body,
    ).toMatchObject({
      case: 'watch',
      value: { points: true, mesh: false },
    });
  });

  it('acknowledges more bytes than 32 bits hold', () => {
    expect(fromBinary(ClientMessageSchema, ackBytes(2 ** 40)).body).toMatchObject({
      case: 'viewerAck',
      value: { bytes: 2n ** 40n },
    });
  });

  it('pings with an id', () => {
    expect(fromBinary(ClientMessageSchema, pingBytes(7)).body).toMatchObject({
      case: 'ping',
      value: { id: 7n },
    });
  });
});

describe('decode', () => {
  it('reads a piece of the surface, and none without a place or of too many triangles', () => {
    const chunk = {
      cube: { part: 1, x: -2, y: 3, z: 4 },
      version: 5n,
      submap: 6,
      triangleCount: 7,
      draco: Uint8Array.of(8),
    };
    const { cube, ...rest } = chunk;
    expect(decode(serverBytes({ case: 'meshChunk', value: chunk }))).toMatchObject({
      kind: 'wireMeshChunk',
      cube,
      ...rest,
    });
    expect(() => decode(serverBytes({ case: 'meshChunk', value: rest }))).toThrow(WireError);
    expect(() =>
      decode(
        serverBytes({
          case: 'meshChunk',
          value: { ...chunk, triangleCount: maxTrianglesPerChunk + 1 },
        }),
      ),
    ).toThrow(WireError);
  });

  it('reads a frame and makes its quaternion a unit one', () => {
    const frame = {
      sequence: 5n,
      worldFromCamera: identity,
      status: TrackingStatus.LOST,
      reason: 'too dark',
      surfelCount: 9n,
      frameMs: 12.5,
    };
    expect(decode(serverBytes({ case: 'frameResult', value: frame }))).toMatchObject({
      kind: 'frame',
      sequence: 5,
      worldFromCamera: { translation: [1, 2, 3], rotation: [0, 0, 0, 1] },
      tracking: 'lost',
      reason: 'too dark',
      surfelCount: 9,
      frame_ms: 12.5,
    });
  });

  it('reads what a frame did to the map', () => {
    const value = {
      worldFromCamera: identity,
      submap: 3,
      submapFromCamera: { ...identity, tx: 0 },
      event: MapEvent.LOOP_CLOSED,
      correctionM: 0.03,
      lastTracked: { sequence: 4n, timestampS: 0.5 },
      uncertainty: { positionSigmaM: 0.012, rotationSigmaRad: 0.002 },
    };
    expect(decode(serverBytes({ case: 'frameResult', value }))).toMatchObject({
      inSubmap: { submap: 3, submapFromCamera: { translation: [0, 2, 3], rotation: [0, 0, 0, 1] } },
      event: 'loopClosed',
      correction_m: 0.03,
      lastTracked: { sequence: 4, timestamp_s: 0.5 },
      positionSigma_m: 0.012,
    });
  });

  it('understands an older server, and an event that only a newer one knows', () => {
    expect(
      decode(serverBytes({ case: 'frameResult', value: { worldFromCamera: identity } })),
    ).toMatchObject({
      inSubmap: null,
      event: 'none',
      correction_m: 0,
      lastTracked: null,
    });
    const value = { worldFromCamera: identity, event: 99 as MapEvent };
    expect(decode(serverBytes({ case: 'frameResult', value }))).toMatchObject({ event: 'none' });
    expect(
      decode(serverBytes({ case: 'trajectoryPart', value: { positions: [1, 2, 3] } })),
    ).toEqual({
      kind: 'trajectory',
      positions_m: Float32Array.of(1, 2, 3),
      submaps: null,
    });
  });

  it('reads the past in the frames of its submaps', () => {
    const value = {
      positions: [1, 2, 3, 4, 5, 6],
      positionsInSubmaps: [1, 2, 3, 0, 0, 6],
      submaps: [0, 7],
    };
    expect(decode(serverBytes({ case: 'trajectoryPart', value }))).toEqual({
      kind: 'trajectory',
      positions_m: Float32Array.of(1, 2, 3, 0, 0, 6),
      submaps: Uint32Array.of(0, 7),
    });
  });

  it('reads the part of a submap', () => {
    const poses = [{ submap: 1, worldFromSubmap: identity, part: 2 }];
    expect(decode(serverBytes({ case: 'submapPoses', value: { poses } }))).toMatchObject({
      poses: [{ submap: 1, part: 2 }],
    });
  });

  it('reads every chunk key and version that the protocol can carry', () => {
    const int32 = fc.integer({ min: -(2 ** 31), max: 2 ** 31 - 1 });
    const uint32 = fc.integer({ min: 0, max: 2 ** 32 - 1 });
    const keys = fc.record({ submap: uint32, level: uint32, x: int32, y: int32, z: int32 });
    fc.assert(
      fc.property(
        keys,
        fc.bigInt({ min: 0n, max: 2n ** 64n - 1n }),
        fc.uint8Array(),
        (key, version, draco) => {
          const bytes = serverBytes({
            case: 'chunk',
            value: { key, version, pointCount: 3, draco: new Uint8Array(draco) },
          });
          expect(decode(bytes)).toEqual({
            kind: 'wireChunk',
            key,
            version,
            pointCount: 3,
            draco: new Uint8Array(draco),
          });
        },
      ),
    );
  });

  it('reads the state of a scan', () => {
    const value = {
      phase: ScanPhase.FINISHED,
      framesReceived: 3n,
      framesProcessed: 2n,
      framesDropped: 1n,
      keyframes: 20n,
      loops: 4n,
      canPause: true,
      up: { inWorld: { x: 1, y: 0, z: 0 }, sigmaRad: 0.02 },
    };
    expect(decode(serverBytes({ case: 'scanState', value }))).toEqual({
      kind: 'scanState',
      phase: 'finished',
      words: '',
      received: 3,
      processed: 2,
      dropped: 1,
      keyframes: 20,
      loops: 4,
      paused: false,
      canPause: true,
      up: { inWorld: [1, 0, 0], sigma_rad: 0.02 },
    });
  });

  it('takes a camera without a size for none', () => {
    expect(decode(serverBytes({ case: 'welcome', value: { title: 'Room' } }))).toEqual({
      kind: 'welcome',
      title: 'Room',
      camera: null,
    });
    expect(
      decode(
        serverBytes({
          case: 'welcome',
          value: { camera: { width: 640, height: 480, fx: NaN, fy: 1 } },
        }),
      ),
    ).toMatchObject({
      camera: null,
    });
  });

  it('ignores messages of a newer protocol', () => {
    expect(decode(Uint8Array.from([0xfa, 0x07, 0x01, 0x00]))).toEqual({ kind: 'unknown' }); // 127
  });

  it.each<[string, Body]>([
    ['a pose that is missing', { case: 'frameResult', value: {} }],
    [
      'a pose that is not finite',
      { case: 'frameResult', value: { worldFromCamera: { ...identity, ty: Infinity } } },
    ],
    [
      'a pose in a submap that is none',
      { case: 'frameResult', value: { worldFromCamera: identity, submapFromCamera: {} } },
    ],
    [
      'a correction that is no length',
      { case: 'frameResult', value: { worldFromCamera: identity, correctionM: NaN } },
    ],
    [
      'an uncertainty that is no length',
      {
        case: 'frameResult',
        value: { worldFromCamera: identity, uncertainty: { positionSigmaM: -1 } },
      },
    ],
    [
      'a negative correction',
      { case: 'frameResult', value: { worldFromCamera: identity, correctionM: -1 } },
    ],
    [
      'a submap too many',
      {
        case: 'trajectoryPart',
        value: { positions: [1, 2, 3], positionsInSubmaps: [1, 2, 3], submaps: [0, 1] },
      },
    ],
    [
      'a position without its submap',
      {
        case: 'trajectoryPart',
        value: { positions: [1, 2, 3], positionsInSubmaps: [1, 2], submaps: [0] },
      },
    ],
    [
      'a zero quaternion',
      { case: 'submapPoses', value: { poses: [{ submap: 1, worldFromSubmap: {} }] } },
    ],
    ['a chunk without a key', { case: 'chunk', value: { pointCount: 1 } }],
    ['too many points', { case: 'chunk', value: { key: {}, pointCount: maxPointsPerChunk + 1 } }],
    ['half a position', { case: 'trajectoryPart', value: { positions: [1, 2, 3, 4] } }],
    [
      'a position that is not a number',
      { case: 'trajectoryPart', value: { positions: [1, NaN, 3] } },
    ],
  ])('refuses %s', (_, body) => {
    expect(() => decode(serverBytes(body))).toThrow(WireError);
  });

  it('answers any bytes with an event or a WireError', () => {
    fc.assert(
      fc.property(fc.uint8Array({ maxLength: 200 }), (bytes) => {
        try {
          decode(bytes);
        } catch (error) {
          expect(error).toBeInstanceOf(WireError);
        }
      }),
    );
  });
});
