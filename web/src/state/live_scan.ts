// Everything that the panels say about one scan, as one value; points and poses
// themselves live in the scene.
import type { ScanSummary } from '../connection/api';
import type {
  FrameEvent,
  MapEventName,
  Pose,
  ScanEvent,
  ScanPhaseName,
  TrackingName,
} from '../connection/events';
import type { Report } from '../connection/scans';
import { noMesh, type MeshState } from './mesh';
import type { Followed } from './quality_text';

export type ConnectionName = 'connecting' | 'open' | 'waiting' | 'closed';

// The last frame that was tracked: what a lost camera is to look at again.
export interface WayBack {
  readonly sequence: number;
  readonly worldFromCamera: Pose;
}

export interface LiveScan {
  readonly scanId: string;
  readonly title: string;
  readonly tags: readonly string[];
  readonly started: Date | null; // by the server's clock; null: not known yet
  readonly connection: ConnectionName;
  readonly connectionText: string; // why it waits or closed
  readonly retryIn_ms: number;
  readonly snapshotComplete: boolean;
  readonly phase: ScanPhaseName;
  readonly phaseText: string;
  readonly paused: boolean; // by its camera, or that is away
  readonly canPause: boolean; // a camera is connected that can be asked to
  readonly framesReceived: number;
  readonly framesProcessed: number;
  readonly framesDropped: number;
  readonly tracking: 'none' | TrackingName;
  readonly trackingReason: string;
  // Since the last tracked frame, by the camera's clock; null before the first.
  readonly lostFor_s: number | null;
  // Of the newest frame; null while lost, or when the server does not say.
  readonly positionSigma_m: number | null;
  readonly sequence: number | null; // of the newest frame; null before the first
  readonly timestamp_s: number; // the same
  readonly wayBack: WayBack | null; // while the camera is lost
  readonly event: {
    readonly name: MapEventName;
    readonly correction_m: number;
    readonly timestamp_s: number;
  } | null; // the newest one
  readonly submaps: number;
  readonly parts: number; // of the map that are not joined
  readonly keyframes: number;
  readonly loops: number;
  readonly frame_ms: number;
  readonly surfels: number;
  // Of the newest tracked frame, in the world.
  readonly cameraPosition_m: readonly [number, number, number] | null;
  readonly poses: number; // camera positions known, those before this viewer came included
  readonly points: number;
  readonly chunks: number;
  readonly triangles: number; // of the surface while it grows
  readonly surfaceHasConfidences: boolean | null; // the same; null: no piece has come
  readonly problem: { readonly code: string; readonly message: string } | null;
  readonly failedChunks: number;
  readonly full: boolean; // the browser's point limit is reached
  readonly old: boolean; // some of what is shown is from before the connection was lost
  readonly mesh: MeshState; // the surface, of a scan that has ended
  readonly report: Report | null; // the same
  readonly followed: Followed | null; // the same: how well the camera was
}

// What the scene, the ledger and the HTTP API tell the state, besides the events of the connection.
export type LiveScanEvent =
  | ScanEvent
  | {
      readonly kind: 'content';
      readonly points: number;
      readonly chunks: number;
      readonly triangles: number;
      readonly full: boolean;
      readonly old: boolean;
    }
  | { readonly kind: 'mesh'; readonly mesh: MeshState }
  | { readonly kind: 'report'; readonly report: Report }
  | { readonly kind: 'followed'; readonly followed: Followed }
  | { readonly kind: 'renamed'; readonly title: string }
  | { readonly kind: 'listed'; readonly as: ScanSummary };

export function hasEnded(phase: ScanPhaseName): boolean {
  return phase === 'finished' || phase === 'failed' || phase === 'interrupted';
}

export function initialLiveScan(scanId: string): LiveScan {
  return {
    scanId,
    title: '',
    tags: [],
    started: null,
    connection: 'connecting',
    connectionText: '',
    retryIn_ms: 0,
    snapshotComplete: false,
    phase: 'unknown',
    phaseText: '',
    paused: false,
    canPause: false,
    framesReceived: 0,
    framesProcessed: 0,
    framesDropped: 0,
    tracking: 'none',
    trackingReason: '',
    lostFor_s: null,
    positionSigma_m: null,
    sequence: null,
    timestamp_s: 0,
    wayBack: null,
    event: null,
    submaps: 0,
    parts: 0,
    keyframes: 0,
    loops: 0,
    frame_ms: 0,
    surfels: 0,
    cameraPosition_m: null,
    poses: 0,
    points: 0,
    chunks: 0,
    triangles: 0,
    surfaceHasConfidences: null,
    problem: null,
    failedChunks: 0,
    full: false,
    old: false,
    mesh: noMesh,
    report: null,
    followed: null,
  };
}

export function reduceLiveScan(state: LiveScan, event: LiveScanEvent): LiveScan {
  switch (event.kind) {
    case 'connecting':
      return { ...state, connection: 'connecting', connectionText: '', snapshotComplete: false };
    case 'welcome':
      return welcomed(state, event.title);
    case 'waiting':
      return {
        ...state,
        connection: 'waiting',
        connectionText: event.reason,
        retryIn_ms: event.retryIn_ms,
      };
    case 'closed':
      return {
        ...state,
        connection: 'closed',
        connectionText: event.reason,
        problem: problemOf(state, event),
      };
    case 'frame':
      return withFrame(state, event);
    case 'trajectory':
      return { ...state, poses: event.positions_m.length / 3 }; // all so far
    case 'scanState':
      return withProgress(state, event);
    case 'serverError':
      return { ...state, problem: { code: event.code, message: event.message } };
    case 'chunkFailed':
      return { ...state, failedChunks: state.failedChunks + 1 };
    case 'snapshotEnd':
      return { ...state, snapshotComplete: true };
    case 'content':
      return {
        ...state,
        points: event.points,
        chunks: event.chunks,
        triangles: event.triangles,
        full: event.full,
        old: event.old,
      };
    case 'mesh':
      return { ...state, mesh: event.mesh };
    case 'report':
      return { ...state, report: event.report };
    case 'followed':
      return { ...state, followed: event.followed };
    case 'renamed':
      return { ...state, title: event.title };
    case 'listed':
      return { ...state, tags: event.as.tags, started: event.as.started };
    case 'submapPoses':
      return {
        ...state,
        submaps: event.poses.length,
        parts: new Set(event.poses.map((pose) => pose.part)).size,
      };
    case 'meshChunk':
      return withConfidences(state, event.piece?.hasConfidences ?? state.surfaceHasConfidences);
    case 'chunk':
      return state; // the scene's business
  }
}

// When a connection begins, perhaps to a server that counts afresh.
function welcomed(state: LiveScan, title: string): LiveScan {
  return {
    ...state,
    connection: 'open',
    title,
    poses: 0,
    event: null,
    sequence: null,
    wayBack: null,
    problem: null,
    failedChunks: 0,
  };
}

function withFrame(state: LiveScan, frame: FrameEvent): LiveScan {
  return {
    ...state,
    tracking: frame.tracking,
    trackingReason: frame.reason,
    lostFor_s: frame.lastTracked ? frame.timestamp_s - frame.lastTracked.timestamp_s : null,
    positionSigma_m: frame.positionSigma_m,
    sequence: frame.sequence,
    timestamp_s: frame.timestamp_s,
    wayBack: wayBackOf(state.wayBack, frame),
    event: newestEvent(state, frame),
    frame_ms: frame.frame_ms,
    surfels: frame.surfelCount,
    cameraPosition_m:
      frame.tracking !== 'lost' ? frame.worldFromCamera.translation : state.cameraPosition_m,
    poses: state.poses + 1,
  };
}

// How far the server is with the scan.
function withProgress(
  state: LiveScan,
  told: Extract<ScanEvent, { readonly kind: 'scanState' }>,
): LiveScan {
  return {
    ...state,
    phase: told.phase,
    phaseText: told.words,
    paused: told.paused,
    canPause: told.canPause,
    framesReceived: told.received,
    framesProcessed: told.processed,
    framesDropped: told.dropped,
    keyframes: told.keyframes,
    loops: told.loops,
  };
}

// The same object while nothing has changed: pieces come often.
function withConfidences(state: LiveScan, surfaceHasConfidences: boolean | null): LiveScan {
  return state.surfaceHasConfidences === surfaceHasConfidences
    ? state
    : { ...state, surfaceHasConfidences };
}

// The same object while it is the same frame, though corrections may move it a little.
function wayBackOf(before: WayBack | null, frame: FrameEvent): WayBack | null {
  if (frame.tracking !== 'lost' || !frame.lastTracked) return null;
  const { sequence } = frame.lastTracked;
  return before?.sequence === sequence
    ? before
    : { sequence, worldFromCamera: frame.worldFromCamera };
}

function newestEvent(state: LiveScan, frame: FrameEvent): LiveScan['event'] {
  return frame.event === 'none'
    ? state.event
    : { name: frame.event, correction_m: frame.correction_m, timestamp_s: frame.timestamp_s };
}

function problemOf(state: LiveScan, closed: { code: string; reason: string }): LiveScan['problem'] {
  if (closed.code === 'complete') return null;
  return state.problem ?? { code: closed.code, message: closed.reason };
}
