// Which stretches of a recording the camera was followed in, doubtful or lost, by the
// camera's clock. Pure functions.
import type { FrameList, FrameStatus } from '../connection/frames';

// 'gap': there are no frames. A frame that was not used belongs to the stretch around it.
export type Follow = 'tracked' | 'weak' | 'lost' | 'unknown' | 'gap';

export interface Stretch {
  readonly follow: Follow;
  readonly first: number; // frames, both of them in it; of a gap those beside it
  readonly last: number;
  readonly frames: number; // that were used
  readonly middle: number; // of these; of a gap the one before it
  readonly from_s: number; // since the first frame
  readonly to_s: number;
}

// A place with weak or lost stretches, and with what lies between them when that is short. Its ends
// say where it is; how long the camera was doubtful or lost in it are sums of its stretches.
export interface Doubt {
  readonly follow: 'weak' | 'lost'; // the worst
  readonly first: number; // frames, as of a stretch
  readonly last: number;
  readonly from_s: number;
  readonly to_s: number;
  readonly weak: number; // frames
  readonly lost: number;
  readonly weak_s: number;
  readonly lost_s: number;
  readonly losses: number; // how often it was lost that had been found before
  readonly middle: number; // the frame that stands for it: of its longest stretch of the worst kind
}

const longestStep_s = 0.25; // from one frame to the next, and
const longestSteps = 4; // this many usual steps; what is longer is a gap
const together_s = 0.5; // doubts this close are one
// A stretch is longer than another one by this; of those as long the first one counts,
// whatever the rounding of times.
const longer_s = 0.001;
const worst: readonly Follow[] = ['lost', 'weak', 'unknown', 'tracked', 'gap'];

const isUsed = (status: FrameStatus): status is 'tracked' | 'weak' | 'lost' | 'unknown' =>
  status === 'tracked' || status === 'weak' || status === 'lost' || status === 'unknown';

interface Used {
  readonly frame: number;
  readonly at_s: number;
  readonly follow: Follow;
}

function usedFrames({ timestamps_s, statuses }: FrameList): Used[] {
  const start_s = timestamps_s.find((time_s) => time_s !== null) ?? 0;
  return statuses.flatMap((status, frame) => {
    const time_s = timestamps_s[frame] ?? null;
    return time_s !== null && isUsed(status)
      ? [{ frame, at_s: time_s - start_s, follow: status }]
      : [];
  });
}

// In their order, without holes: each ends where the next one begins.
export function stretchesOf(list: FrameList): Stretch[] {
  const used = usedFrames(list);
  const steps_s = used.slice(1).map(({ at_s }, i) => at_s - used[i]!.at_s);
  const usual_s = [...steps_s].sort((a, b) => a - b)[Math.floor(steps_s.length / 2)] ?? 0;
  const longest_s = Math.max(longestStep_s, longestSteps * usual_s);
  const found: Stretch[] = [];
  let begun = 0; // the first of the used frames in the last stretch
  const add = (next: Stretch, i: number): void => {
    const before = found.at(-1);
    if (before?.follow !== next.follow) {
      found.push(next);
      begun = i;
    } else
      found[found.length - 1] = {
        ...before,
        last: next.last,
        frames: before.frames + next.frames,
        middle: used[Math.floor((begun + i) / 2)]!.frame,
        to_s: next.to_s,
      };
  };
  if (used[0] && used[0].at_s > 0)
    add(
      {
        follow: 'gap',
        first: 0,
        last: used[0].frame,
        frames: 0,
        middle: 0,
        from_s: 0,
        to_s: used[0].at_s,
      },
      0,
    );
  used.forEach(({ frame, at_s, follow }, i) => {
    const after = used[i + 1];
    const isGap = after !== undefined && after.at_s - at_s > longest_s;
    const to_s = after === undefined || isGap ? at_s + usual_s : after.at_s;
    add({ follow, first: frame, last: frame, frames: 1, middle: frame, from_s: at_s, to_s }, i);
    if (isGap)
      add(
        {
          follow: 'gap',
          first: frame,
          last: after.frame,
          frames: 0,
          middle: frame,
          from_s: to_s,
          to_s: after.at_s,
        },
        i,
      );
  });
  return found;
}

export function doubtsIn(stretches: readonly Stretch[]): Doubt[] {
  const found: Doubt[] = [];
  // Since before this stretch: a camera that is lost on both sides of a gap was not found in it.
  let isLost = false;
  let longest_s = 0; // of the stretches of the worst kind in the last place
  for (const stretch of stretches) {
    const next = doubtOf(stretch, isLost);
    if (stretch.follow !== 'gap') isLost = stretch.follow === 'lost';
    if (!next) continue;
    const before = found.at(-1);
    const long_s = stretch.to_s - stretch.from_s;
    if (!before || next.from_s - before.to_s > together_s) {
      found.push(next);
      longest_s = long_s;
      continue;
    }
    const isWorse = before.follow === 'weak' && next.follow === 'lost';
    const standsForIt = isWorse || (before.follow === next.follow && long_s > longest_s + longer_s);
    if (standsForIt) longest_s = long_s;
    found[found.length - 1] = together(before, next, standsForIt ? next.middle : before.middle);
  }
  return found;
}

function doubtOf(
  { follow, first, last, from_s, to_s, frames, middle }: Stretch,
  wasLost: boolean,
): Doubt | null {
  const place = { first, last, from_s, to_s, middle };
  if (follow === 'weak')
    return { ...place, follow, weak: frames, lost: 0, weak_s: to_s - from_s, lost_s: 0, losses: 0 };
  return follow === 'lost'
    ? {
        ...place,
        follow,
        weak: 0,
        lost: frames,
        weak_s: 0,
        lost_s: to_s - from_s,
        losses: wasLost ? 0 : 1,
      }
    : null;
}

function together(a: Doubt, b: Doubt, middle: number): Doubt {
  return {
    follow: a.lost + b.lost > 0 ? 'lost' : 'weak',
    first: a.first,
    last: b.last,
    from_s: a.from_s,
    to_s: b.to_s,
    weak: a.weak + b.weak,
    lost: a.lost + b.lost,
    weak_s: a.weak_s + b.weak_s,
    lost_s: a.lost_s + b.lost_s,
    losses: a.losses + b.losses,
    middle,
  };
}

// A piece of the strip, in shares of its length.
export interface StripPiece {
  readonly follow: Follow;
  readonly from: number;
  readonly to: number;
}

// At most `most` pieces, however many frames there are: where stretches are shorter than
// that, the worst one is seen.
export function stripOf(stretches: readonly Stretch[], most: number): StripPiece[] {
  const whole_s = stretches.at(-1)?.to_s ?? 0;
  if (whole_s <= 0) return stretches.slice(0, 1).map(({ follow }) => ({ follow, from: 0, to: 1 }));
  if (stretches.length <= most / 3)
    return stretches.map(({ follow, from_s, to_s }) => ({
      follow,
      from: from_s / whole_s,
      to: to_s / whole_s,
    }));
  const bins = new Array<Follow>(most).fill('gap');
  for (const { follow, from_s, to_s } of stretches) {
    const first = Math.min(most - 1, Math.floor((from_s / whole_s) * most));
    const last = Math.min(most - 1, Math.max(first, Math.ceil((to_s / whole_s) * most) - 1));
    for (let bin = first; bin <= last; ++bin)
      if (worst.indexOf(follow) < worst.indexOf(bins[bin]!)) bins[bin] = follow;
  }
  const pieces: StripPiece[] = [];
  bins.forEach((follow, bin) => {
    const before = pieces.at(-1);
    if (before?.follow === follow) pieces[pieces.length - 1] = { ...before, to: (bin + 1) / most };
    else pieces.push({ follow, from: bin / most, to: (bin + 1) / most });
  });
  return pieces;
}

// Of frames that were sent and not used: their share in each of `count` equal times,
// empty when all were used.
export function unusedShares(
  { timestamps_s, statuses }: FrameList,
  whole_s: number,
  count: number,
): number[] {
  if (whole_s <= 0 || statuses.every(isUsed)) return [];
  const [unused, all] = [new Array<number>(count).fill(0), new Array<number>(count).fill(0)];
  const start_s = timestamps_s.find((time_s) => time_s !== null) ?? 0;
  let at_s = 0;
  statuses.forEach((status, frame) => {
    const time_s = timestamps_s[frame] ?? null;
    // A frame without an image is where the one before it is.
    if (time_s !== null) at_s = time_s - start_s;
    const bin = Math.max(0, Math.min(count - 1, Math.floor((at_s / whole_s) * count)));
    all[bin]! += 1;
    if (!isUsed(status)) unused[bin]! += 1;
  });
  return unused.map((number, bin) => (all[bin] === 0 ? 0 : number / all[bin]!));
}

// The frame that was sent last at this share of the recording; null when there is none.
export function frameAt(
  { timestamps_s }: FrameList,
  whole_s: number,
  share: number,
): number | null {
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
