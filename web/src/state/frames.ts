// Looking back at what a camera has seen: which frame plays when, what is said of one, and fetching
// that keeps up with whoever drags. No page in here.
import type { DepthRange, FrameList, FrameStatus } from '../connection/frames';
import { t } from '../texts/texts';
import { clockText } from './quantities';
import type { StatusText } from './text';

// Nothing plays in a longer step: a pause of the camera may have taken half an hour.
const longestStep_s = 1;

// The frame to be seen so many seconds after frame `from`, by the camera's clock; frames without
// an image are passed over.
export function frameAfter({ timestamps_s }: FrameList, from: number, elapsed_s: number): number {
  let [at, at_s, played_s] = [from, timestamps_s[from] ?? null, 0];
  for (let i = from + 1; i < timestamps_s.length; ++i) {
    const time_s = timestamps_s[i] ?? null;
    if (time_s === null) continue;
    played_s += Math.min(longestStep_s, time_s - (at_s ?? time_s));
    if (played_s > elapsed_s) break;
    [at, at_s] = [i, time_s];
  }
  return at;
}

// Next to that one with an image, or that one itself where there is none.
export function nextImage({ timestamps_s }: FrameList, from: number, step: 1 | -1): number {
  for (let i = from + step; i >= 0 && i < timestamps_s.length; i += step)
    if ((timestamps_s[i] ?? null) !== null) return i;
  return from;
}

export function statusText(status: FrameStatus): StatusText {
  switch (status) {
    case 'tracked':
      return { text: t.tracked, tone: 'good' };
    case 'weak':
      return { text: t.weakNearlyLostButUsed, tone: 'warn' };
    case 'lost':
      return { text: t.lostNotUsedShownWhereIt, tone: 'bad' };
    case 'left_out':
      return { text: t.leftOutThereWasNoTime, tone: 'warn' };
    case 'refused':
      return { text: t.refusedItsTimeWasNotAfter, tone: 'bad' };
    case 'damaged':
      return { text: t.damagedOnTheServersDisk, tone: 'bad' };
    case 'unknown':
      return { text: t.whatBecameOfItIsNot, tone: 'quiet' };
  }
}

// Since the first frame: "1:02.033"; empty where there is no time.
export function timeText({ timestamps_s }: FrameList, frame: number): string {
  const first_s = timestamps_s.find((known_s) => known_s !== null) ?? 0;
  const time_s = timestamps_s[frame] ?? null;
  return time_s === null ? '' : clockText(Math.max(0, time_s - first_s), 3);
}

const step_mm = 100; // the range goes in such steps, so that colours do not change with every frame

// Wide enough for both.
export function widened(range: DepthRange | null, measured: DepthRange): DepthRange | null {
  if (measured.to_mm === 0) return range;
  const from_mm = Math.floor(measured.from_mm / step_mm) * step_mm;
  const to_mm = Math.max(from_mm + step_mm, Math.ceil(measured.to_mm / step_mm) * step_mm);
  return range
    ? { from_mm: Math.min(range.from_mm, from_mm), to_mm: Math.max(range.to_mm, to_mm) }
    : { from_mm, to_mm };
}

// Fetches what is wished for, one at a time: while one is on its way only the newest wish is kept.
export class OneAtATime<Item> {
  private wish: number | null = null;
  private onItsWay: AbortController | null = null;

  constructor(
    private readonly fetch: (which: number, signal: AbortSignal) => Promise<Item>,
    private readonly got: (which: number, item: Item) => void,
    private readonly failed: (which: number, error: unknown) => void,
  ) {}

  get isBusy(): boolean {
    return this.onItsWay !== null;
  }

  want(which: number): void {
    this.wish = which;
    if (!this.onItsWay) void this.go();
  }

  // What is on its way is not wanted any more.
  stop(): void {
    this.wish = null;
    this.onItsWay?.abort();
    this.onItsWay = null;
  }

  private async go(): Promise<void> {
    const mine = (this.onItsWay = new AbortController());
    while (this.wish !== null) {
      const which = this.wish;
      this.wish = null;
      try {
        const item = await this.fetch(which, mine.signal);
        if (this.onItsWay === mine) this.got(which, item);
      } catch (error) {
        if (this.onItsWay === mine) this.failed(which, error);
      }
      if (this.onItsWay !== mine) return;
    }
    this.onItsWay = null;
  }
}
