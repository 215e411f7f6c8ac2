// Events as a server would tell them, for the tests of layers.
import type { FrameEvent, Pose, ScanEvent } from '../connection/events';

export const at = (x: number): Pose => ({ translation: [x, 0, 0], rotation: [0, 0, 0, 1] });

// `where`: of each submap on the x axis.
export const poses = (where: readonly number[], parts: readonly number[] = []): ScanEvent => ({
  kind: 'submapPoses',
  poses: where.map((x, submap) => ({ submap, worldFromSubmap: at(x), part: parts[submap] ?? 0 })),
});

const noneYet = {
  received: 0,
  processed: 0,
  dropped: 0,
  keyframes: 0,
  loops: 0,
  paused: false,
  canPause: false,
  up: null,
};
export const running: ScanEvent = { kind: 'scanState', phase: 'running', words: '', ...noneYet };

export function frame(submap: number, x: number, changes: Partial<FrameEvent> = {}): FrameEvent {
  return {
    kind: 'frame',
    sequence: 0,
    timestamp_s: 0,
    worldFromCamera: at(x),
    tracking: 'tracked',
    reason: '',
    inlierRatio: 1,
    residual_m: 0,
    surfelCount: 1,
    frame_ms: 1,
    inSubmap: { submap, submapFromCamera: at(x) },
    event: 'none',
    correction_m: 0,
    lastTracked: { sequence: 0, timestamp_s: 0 },
    positionSigma_m: null,
    ...changes,
  };
}
