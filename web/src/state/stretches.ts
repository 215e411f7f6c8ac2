// Which stretches of a recording the camera was followed in, doubtful or lost, by the camera's clock. Pure functions.
import type { FrameList, FrameStatus } from '../connection/frames';

// 'gap': there are no frames. A frame that was not used belongs to the stretch around it.
export type Follow = 'tracked' | 'weak' | 'lost' | 'unknown' | 'gap';

export interface Stretch {
  readonly follow: Follow;
  readonly first: number; // frames, both of them in it; of a gap those beside it
  readonly last: number;
  readonly frames: number; // that were used
  readonly from_s: number; // since the first frame
  readonly to_s: number;
}

// Weak or lost, with what lies between when that is short.
export interface Doubt extends Stretch {
  readonly weak: number; // frames
  readonly lost: number;
  readonly middle: number; // the frame that stands for it: of the worst kind that is in it
}

const longestStep_s = 0.25; // from one frame to the next, and
const longestSteps = 4; // this many usual steps; what is longer is a gap
const together_s = 0.5; // doubts this close are one
const worst: readonly Follow[] = ['lost', 'weak', 'unknown', 'tracked', 'gap'];

const isUsed = (status: FrameStatus): status is 'tracked' | 'weak' | 'lost' | 'unknown' => status === 'tracked' || status === 'weak' || status === 'lost' || status === 'unknown';

interface Used {
  readonly frame: number;
  readonly at_s: number;
  readonly follow: Follow;
}

function usedFrames({ timestamps_s, statuses }: FrameList): Used[] {
  const start_s = timestamps_s.find((time_s) => time_s !== null) ?? 0;
  return statuses.flatMap((status, frame) => {
    const time_s = timestamps_s[frame] ?? null;
    return time_s !== null && isUsed(status) ? [{ frame, at_s: time_s - start_s, follow: status }] : [];
  });
}

// In their order, without holes: each ends where the next one begins.
export function stretchesOf(list: FrameList): Stretch[] {
  const used = usedFrames(list);
  const steps_s = used.slice(1).map(({ at_s }, i) => at_s - used[i]!.at_s);
  const usual_s = [...steps_s].sort((a, b) => a - b)[Math.floor(steps_s.length / 2)] ?? 0;
  const longest_s = Math.max(longestStep_s, longestSteps * usual_s);
  const found: Stretch[] = [];
  const add = (next: Stretch): void => {
    const before = found.at(-1);
    if (before?.follow !== next.follow) found.push(next);
    else found[found.length - 1] = { ...before, last: next.last, frames: before.frames + next.frames, to_s: next.to_s };
  };
  if (used[0] && used[0].at_s > 0) add({ follow: 'gap', first: 0, last: used[0].frame, frames: 0, from_s: 0, to_s: used[0].at_s });
  used.forEach(({ frame, at_s, follow }, i) => {
    const after = used[i + 1];
    const isGap = after !== undefined && after.at_s - at_s > longest_s;
    const to_s = after === undefined || isGap ? at_s + usual_s : after.at_s;
    add({ follow, first: frame, last: frame, frames: 1, from_s: at_s, to_s });
    if (isGap) add({ follow: 'gap', first: frame, last: after.frame, frames: 0, from_s: to_s, to_s: after.at_s });
  });
  return found;
}

export function doubtsIn(stretches: readonly Stretch[]): Doubt[] {
  const found: Doubt[] = [];
  for (const stretch of stretches) {
    if (stretch.follow !== 'weak' && stretch.follow !== 'lost') continue;
    const [weak, lost] = stretch.follow === 'weak' ? [stretch.frames, 0] : [0, stretch.frames];
    const middle = Math.floor((stretch.first + stretch.last) / 2);
    const before = found.at(-1);
    if (!before || stretch.from_s - before.to_s > together_s) {
      found.push({ ...stretch, weak, lost, middle });
      continue;
    }
    const isWorse = before.follow === 'weak' && stretch.follow === 'lost';
    found[found.length - 1] = {
      follow: isWorse ? 'lost' : before.follow,
      first: before.first,
      last: stretch.last,
      frames: before.frames + stretch.frames,
      from_s: before.from_s,
      to_s: stretch.to_s,
      weak: before.weak + weak,
      lost: before.lost + lost,
      middle: isWorse ? middle : before.middle,
    };
  }
  return found;
}

// A piece of the strip, in shares of its length.
export interface StripPiece {
  readonly follow: Follow;
  readonly from: number;
  readonly to: number;
}

// At most `most` pieces, however many frames there are: where stretches are shorter than that, the worst one is seen.
export function stripOf(stretches: readonly Stretch[], most: number): StripPiece[] {
  const whole_s = stretches.at(-1)?.to_s ?? 0;
  if (whole_s <= 0) return stretches.slice(0, 1).map(({ follow }) => ({ follow, from: 0, to: 1 }));
  if (stretches.length <= most / 3) return stretches.map(({ follow, from_s, to_s }) => ({ follow, from: from_s / whole_s, to: to_s / whole_s }));
  const bins = new Array<Follow>(most).fill('gap');
  for (const { follow, from_s, to_s } of stretches) {
    const first = Math.min(most - 1, Math.floor((from_s / whole_s) * most));
    const last = Math.min(most - 1, Math.max(first, Math.ceil((to_s / whole_s) * most) - 1));
    for (let bin = first; bin <= last; ++bin) if (worst.indexOf(follow) < worst.indexOf(bins[bin]!)) bins[bin] = follow;
  }
  const pieces: StripPiece[] = [];
  bins.forEach((follow, bin) => {
    const before = pieces.at(-1);
    if (before?.follow === follow) pieces[pieces.length - 1] = { ...before, to: (bin + 1) / most };
    else pieces.push({ follow, from: bin / most, to: (bin + 1) / most });
  });
  return pieces;
}

// Of frames that were sent and not used: their share in each of `count` equal times, empty when all were used.
export function unusedShares({ timestamps_s, statuses }: FrameList, whole_s: number, count: number): number[] {
  if (whole_s <= 0 || statuses.every(isUsed)) return [];
  const [unused, all] = [new Array<number>(count).fill(0), new Array<number>(count).fill(0)];
  const start_s = timestamps_s.find((time_s) => time_s !== null) ?? 0;
  let at_s = 0;
  statuses.forEach((status, frame) => {
    const time_s = timestamps_s[frame] ?? null;
    if (time_s !== null) at_s = time_s - start_s; // one without an image is where the one before it is
    const bin = Math.max(0, Math.min(count - 1, Math.floor((at_s / whole_s) * count)));
    all[bin]! += 1;
    if (!isUsed(status)) unused[bin]! += 1;
  });
  return unused.map((number, bin) => (all[bin] === 0 ? 0 : number / all[bin]!));
}

// The frame that was sent last at this share of the recording; null when there is none.
export function frameAt({ timestamps_s }: FrameList, whole_s: number, share: number): number | null {
  const start_s = timestamps_s.find((time_s) => time_s !== null) ?? 0;
  let found: number | null = null;
  for (let frame = 0; frame < timestamps_s.length; ++frame) {
    const time_s = timestamps_s[frame] ?? null;
    if (time_s === null) continue;
    if (found !== null && time_s - start_s > share * whole_s) break;
    found = frame;
  }
  return found;
}

export type FrameCounts = Readonly<Record<FrameStatus, number>>;

export function countsOf(statuses: readonly FrameStatus[]): FrameCounts {
  const counts = { tracked: 0, weak: 0, lost: 0, left_out: 0, refused: 0, damaged: 0, unknown: 0 };
  for (const status of statuses) ++counts[status];
  return counts;
}
