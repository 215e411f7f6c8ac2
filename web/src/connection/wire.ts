// Protobuf bytes <-> the values of events.ts. Everything read is checked here once; what is wrong
// throws a WireError with a message.
import { create, fromBinary, toBinary, type MessageInitShape } from '@bufbuild/protobuf';
import {
  ClientMessageSchema,
  MapEvent,
  ScanPhase,
  ServerMessageSchema,
  TrackingStatus,
  type Camera,
  type Chunk,
  type FrameResult,
  type MeshChunk,
  type Rigid3,
  type ServerMessage,
  type TrajectoryPart,
  type UpDirection,
} from '../gen/scan_pb';
import type {
  CameraIntrinsics,
  ChunkKey,
  FrameEvent,
  MeshCube,
  MapEventName,
  MeasuredUp,
  PastPositions,
  Pose,
  ScanEvent,
  ScanPhaseName,
  TrackingName,
  Watch,
} from './events';

export class WireError extends Error {}

export const protocolMinor = 8;
export const maxPointsPerChunk = 262144;
export const maxTrianglesPerChunk = 262144;

export interface WireChunk {
  readonly kind: 'wireChunk';
  readonly key: ChunkKey;
  readonly version: bigint;
  readonly pointCount: number; // 0: the chunk is gone
  readonly draco: Uint8Array;
}

export interface WireMeshChunk {
  readonly kind: 'wireMeshChunk';
  readonly cube: MeshCube;
  readonly version: bigint;
  readonly submap: number;
  readonly triangleCount: number; // 0: the piece is gone
  readonly draco: Uint8Array;
}

export type Incoming =
  | ScanEvent
  | WireChunk
  | WireMeshChunk
  | { readonly kind: 'pong' }
  | { readonly kind: 'unknown' };

export function helloBytes(scanId: string, token: string, watch: Watch): Uint8Array<ArrayBuffer> {
  return encode({
    case: 'hello',
    value: {
      protocolMinor,
      client: 'hermite-viewer 0.1.0',
      token,
      role: { case: 'viewScan', value: { scanId, watch } },
    },
  });
}

export function watchBytes(watch: Watch): Uint8Array<ArrayBuffer> {
  return encode({ case: 'watch', value: watch });
}

// Bytes received so far on this connection.
export function ackBytes(received: number): Uint8Array<ArrayBuffer> {
  return encode({ case: 'viewerAck', value: { bytes: BigInt(received) } });
}

export function pingBytes(id: number): Uint8Array<ArrayBuffer> {
  return encode({ case: 'ping', value: { id: BigInt(id) } });
}

function encode(
  body: NonNullable<MessageInitShape<typeof ClientMessageSchema>['body']>,
): Uint8Array<ArrayBuffer> {
  return toBinary(ClientMessageSchema, create(ClientMessageSchema, { body }));
}

export function decode(bytes: Uint8Array): Incoming {
  let message: ServerMessage;
  try {
    message = fromBinary(ServerMessageSchema, bytes);
  } catch (error) {
    throw new WireError(
      `a message of ${bytes.length} bytes is not a ServerMessage: ${(error as Error).message}`,
    );
  }
  const body = message.body;
  switch (body.case) {
    case 'welcome':
      return { kind: 'welcome', title: body.value.title, camera: cameraOf(body.value.camera) };
    case 'frameResult':
      return frameOf(body.value);
    case 'chunk':
      return chunkOf(body.value);
    case 'meshChunk':
      return meshChunkOf(body.value);
    case 'submapPoses':
      return {
        kind: 'submapPoses',
        poses: body.value.poses.map(({ submap, worldFromSubmap, part }) => ({
          submap,
          worldFromSubmap: poseOf(worldFromSubmap, 'world_from_submap'),
          part,
        })),
      };
    case 'trajectoryPart':
      return { kind: 'trajectory', ...pastOf(body.value) };
    case 'scanState':
      return {
        kind: 'scanState',
        phase: phaseOf(body.value.phase),
        words: body.value.words,
        received: Number(body.value.framesReceived),
        processed: Number(body.value.framesProcessed),
        dropped: Number(body.value.framesDropped),
        keyframes: Number(body.value.keyframes),
        loops: Number(body.value.loops),
        paused: body.value.paused,
        canPause: body.value.canPause,
        up: measuredUp(body.value.up),
      };
    case 'error':
      return { kind: 'serverError', code: body.value.code, message: body.value.message };
    case 'snapshotEnd':
      return { kind: 'snapshotEnd' };
    case 'pong':
      return { kind: 'pong' };
    default:
      return { kind: 'unknown' }; // of a newer minor version, or not for viewers
  }
}

function trackingOf(status: TrackingStatus): TrackingName {
  if (status === TrackingStatus.TRACKED) return 'tracked';
  return status === TrackingStatus.WEAK ? 'weak' : 'lost'; // of a newer server: the cautious answer
}

const eventNames: Partial<Record<MapEvent, MapEventName>> = {
  [MapEvent.LOST]: 'lost',
  [MapEvent.FOUND_AGAIN]: 'foundAgain',
  [MapEvent.NEW_PART]: 'newPart',
  [MapEvent.JOINED]: 'joined',
  [MapEvent.LOOP_CLOSED]: 'loopClosed',
  [MapEvent.RECALIBRATED]: 'recalibrated',
};

function frameOf(frame: FrameResult): FrameEvent {
  return {
    kind: 'frame',
    sequence: Number(frame.sequence),
    timestamp_s: frame.timestampS,
    worldFromCamera: poseOf(frame.worldFromCamera, 'world_from_camera'),
    tracking: trackingOf(frame.status),
    reason: frame.reason,
    inlierRatio: frame.inlierRatio,
    residual_m: frame.residualRmsM,
    surfelCount: Number(frame.surfelCount),
    frame_ms: frame.frameMs,
    inSubmap: frame.submapFromCamera
      ? {
          submap: frame.submap,
          submapFromCamera: poseOf(frame.submapFromCamera, 'submap_from_camera'),
        }
      : null,
    event: eventNames[frame.event] ?? 'none', // of a newer server: nothing that there is a text for
    correction_m: lengthOf(frame.correctionM, 'correction_m'),
    lastTracked: frame.lastTracked
      ? { sequence: Number(frame.lastTracked.sequence), timestamp_s: frame.lastTracked.timestampS }
      : null,
    positionSigma_m: frame.uncertainty
      ? lengthOf(frame.uncertainty.positionSigmaM, 'uncertainty.position_sigma_m')
      : null,
  };
}

function chunkOf(chunk: Chunk): WireChunk {
  if (!chunk.key) throw new WireError('a chunk has no key');
  const { submap, level, x, y, z } = chunk.key;
  if (chunk.pointCount > maxPointsPerChunk) {
    throw new WireError(
      `a chunk declares ${chunk.pointCount} points, the limit is ${maxPointsPerChunk}`,
    );
  }
  return {
    kind: 'wireChunk',
    key: { submap, level, x, y, z },
    version: chunk.version,
    pointCount: chunk.pointCount,
    draco: chunk.draco,
  };
}

function meshChunkOf({ cube, version, submap, triangleCount, draco }: MeshChunk): WireMeshChunk {
  if (!cube) throw new WireError('a piece of mesh has no cube');
  if (triangleCount > maxTrianglesPerChunk) {
    throw new WireError(
      `a piece of mesh declares ${triangleCount} triangles, the limit is ${maxTrianglesPerChunk}`,
    );
  }
  const { part, x, y, z } = cube;
  return { kind: 'wireMeshChunk', cube: { part, x, y, z }, version, submap, triangleCount, draco };
}

function cameraOf(camera: Camera | undefined): CameraIntrinsics | null {
  if (!camera || camera.width === 0 || camera.height === 0) return null;
  const { width, height, fx, fy, cx, cy } = camera;
  if (![fx, fy, cx, cy].every(Number.isFinite) || fx === 0 || fy === 0) return null;
  return { width, height, fx, fy, cx, cy };
}

function poseOf(pose: Rigid3 | undefined, field: string): Pose {
  if (!pose) throw new WireError(`${field} is missing`);
  const { tx, ty, tz, qx, qy, qz, qw } = pose;
  const norm = Math.hypot(qx, qy, qz, qw);
  if (![tx, ty, tz].every(Number.isFinite) || !Number.isFinite(norm) || norm < 1e-6)
    throw new WireError(`${field} is not a pose`);
  return { translation: [tx, ty, tz], rotation: [qx / norm, qy / norm, qz / norm, qw / norm] };
}

function lengthOf(length_m: number, field: string): number {
  if (!Number.isFinite(length_m) || length_m < 0)
    throw new WireError(`${field} is ${length_m}, not a length`);
  return length_m;
}

function pastOf(part: TrajectoryPart): PastPositions {
  const inWorld_m = positionsOf(part.positions);
  if (part.submaps.length === 0) return { positions_m: inWorld_m, submaps: null };
  if (
    part.positionsInSubmaps.length !== inWorld_m.length ||
    3 * part.submaps.length !== inWorld_m.length
  ) {
    throw new WireError(
      `a trajectory part has ${part.submaps.length} submaps for ${inWorld_m.length / 3} positions`,
    );
  }
  return {
    positions_m: positionsOf(part.positionsInSubmaps),
    submaps: Uint32Array.from(part.submaps),
  };
}

function positionsOf(positions: readonly number[]): Float32Array {
  if (positions.length % 3 !== 0)
    throw new WireError(`a trajectory part has ${positions.length} numbers, not a multiple of 3`);
  if (!positions.every(Number.isFinite))
    throw new WireError('a trajectory part has a position that is not finite');
  return Float32Array.from(positions);
}

function measuredUp(up: UpDirection | undefined): MeasuredUp | null {
  if (!up?.inWorld) return null;
  const { x, y, z } = up.inWorld;
  return { inWorld: [x, y, z], sigma_rad: up.sigmaRad };
}

function phaseOf(phase: ScanPhase): ScanPhaseName {
  switch (phase) {
    case ScanPhase.RUNNING:
      return 'running';
    case ScanPhase.FINISHED:
      return 'finished';
    case ScanPhase.FAILED:
      return 'failed';
    case ScanPhase.INTERRUPTED:
      return 'interrupted';
    default:
      return 'unknown';
  }
}
