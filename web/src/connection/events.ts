// What the worker tells the page about one scan: plain values, already decoded and checked. Lengths
// are metres, the frame is in the name.

export interface Pose {
  readonly translation: readonly [number, number, number];
  readonly rotation: readonly [number, number, number, number]; // unit quaternion x y z w
}

// Pixel centres are integers, lengths in pixels.
export interface CameraIntrinsics {
  readonly width: number;
  readonly height: number;
  readonly fx: number;
  readonly fy: number;
  readonly cx: number;
  readonly cy: number;
}

export interface ChunkKey {
  readonly submap: number;
  readonly level: number;
  readonly x: number;
  readonly y: number;
  readonly z: number;
}

// `count` points in the frame of their submap.
export interface ChunkPoints {
  readonly count: number;
  readonly positions_m: Float32Array; // 3 a point
  readonly colors: Uint8Array; // 4 a point: red, green, blue (sRGB) and confidence * 8
  // Four a point: x, y, z times 127 and a zero; all zero where there is no normal.
  readonly normals: Int8Array;
  readonly radii_m: Float32Array; // of discs that leave no gaps (spacing.ts)
  readonly min_m: readonly [number, number, number];
  readonly max_m: readonly [number, number, number];
}

// What the viewer wants to see of the model of a scan that runs.
export interface Watch {
  readonly points: boolean;
  readonly mesh: boolean;
}

// Of the world, in which a part of the map is meshed.
export interface MeshCube {
  readonly part: number;
  readonly x: number;
  readonly y: number;
  readonly z: number;
}

// In the frame of a submap.
export interface MeshPiece {
  readonly triangles: number;
  readonly index: Uint32Array; // 3 a triangle
  readonly positions_m: Float32Array; // 3 a vertex
  readonly normals: Int8Array; // 4 a vertex: x, y, z times 127 and a zero
  // Four a vertex: red, green, blue (sRGB) and confidence * 8, as points have it;
  // 255 without confidences.
  readonly colors: Uint8Array;
  readonly hasConfidences: boolean; // since minor 7
}

export type ScanPhaseName = 'unknown' | 'running' | 'finished' | 'failed' | 'interrupted';

export type TrackingName = 'tracked' | 'weak' | 'lost';

export type MapEventName =
  | 'none'
  | 'lost'
  | 'foundAgain'
  | 'newPart'
  | 'joined'
  | 'loopClosed'
  | 'recalibrated';

export interface FrameEvent {
  readonly kind: 'frame';
  readonly sequence: number;
  readonly timestamp_s: number;
  readonly worldFromCamera: Pose;
  readonly tracking: TrackingName;
  readonly reason: string; // for people, when weak or lost
  readonly inlierRatio: number;
  readonly residual_m: number;
  readonly surfelCount: number;
  readonly frame_ms: number;
  // The same pose as it stays when submaps are corrected; null from an older server.
  readonly inSubmap: PoseInSubmap | null;
  readonly event: MapEventName; // what the frame did to the map besides adding to it
  // The farthest that a submap around the camera was moved in this frame.
  readonly correction_m: number;
  // This frame, or while lost the one that the pose is of; null before the first.
  readonly lastTracked: { readonly sequence: number; readonly timestamp_s: number } | null;
  // Of the camera's position along the axis of the greatest error; null while lost,
  // and from an older server.
  readonly positionSigma_m: number | null;
}

export interface PoseInSubmap {
  readonly submap: number;
  readonly submapFromCamera: Pose;
}

export interface SubmapPose {
  readonly submap: number;
  readonly worldFromSubmap: Pose;
  readonly part: number; // submaps of different parts are not joined yet
}

// x y z, x y z, ... Without submaps: in the world. With them, one a position: each in
// the frame of its submap.
export interface PastPositions {
  readonly positions_m: Float32Array;
  readonly submaps: Uint32Array | null;
}

// `waited_ms`: from when its bytes came until it was decoded.
export type ScanEvent =
  | { readonly kind: 'connecting'; readonly attempt: number }
  | { readonly kind: 'welcome'; readonly title: string; readonly camera: CameraIntrinsics | null }
  | { readonly kind: 'waiting'; readonly retryIn_ms: number; readonly reason: string }
  // Closed for good: nobody tries again.
  | { readonly kind: 'closed'; readonly code: string; readonly reason: string }
  | FrameEvent
  | { readonly kind: 'submapPoses'; readonly poses: readonly SubmapPose[] }
  | ({ readonly kind: 'trajectory' } & PastPositions)
  | {
      readonly kind: 'chunk';
      readonly key: ChunkKey;
      readonly version: bigint;
      readonly points: ChunkPoints | null;
      readonly waited_ms?: number;
    } // null: removed
  | {
      readonly kind: 'meshChunk';
      readonly cube: MeshCube;
      readonly version: bigint;
      readonly submap: number;
      readonly piece: MeshPiece | null;
      readonly waited_ms?: number;
    } // null: removed
  | { readonly kind: 'chunkFailed'; readonly key: ChunkKey | MeshCube; readonly reason: string }
  | { readonly kind: 'snapshotEnd' }
  | {
      readonly kind: 'scanState';
      readonly phase: ScanPhaseName;
      readonly words: string;
      readonly received: number;
      readonly processed: number;
      readonly dropped: number;
      readonly keyframes: number;
      readonly loops: number; // closed so far
      readonly paused: boolean; // no frames are to be expected at the moment
      readonly canPause: boolean; // a camera is connected that can be asked to pause
      readonly up: MeasuredUp | null; // by the camera's accelerometer, if it has one
    }
  | { readonly kind: 'serverError'; readonly code: string; readonly message: string };

export type Direction = readonly [number, number, number];

// In the world of the scan, with the standard deviation of its angle.
export interface MeasuredUp {
  readonly inWorld: Direction;
  readonly sigma_rad: number;
}

export type ToWorker =
  | {
      readonly kind: 'open';
      readonly url: string;
      readonly scanId: string;
      readonly token: string;
      readonly watch: Watch;
    }
  | { readonly kind: 'watch'; readonly watch: Watch }
  | { readonly kind: 'alive?' };

export type FromWorker =
  | { readonly kind: 'event'; readonly event: ScanEvent }
  | { readonly kind: 'alive' };
