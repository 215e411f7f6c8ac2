// How long a running scan has been going, and how fast its frames come.
import { decimal } from '../texts/texts';
import type { LiveScan } from './live_scan';
import { clockText } from './quantities';

const window_ms = 5000; // long enough that slow frames have a rate, short enough that it is news
const least_ms = 1000; // over less, one late frame would be all that it says

// Counts the frames that the camera has sent, by their numbers: not each of them is told to a page
// that is slow.
export class PaceMeter {
  private frames: { readonly sequence: number; readonly at_ms: number }[] = [];

  // The newest frame; null: there is none yet, perhaps of a new connection.
  frame(sequence: number | null, at_ms: number): void {
    const last = this.frames.at(-1);
    if (sequence === null || (last && sequence < last.sequence)) this.frames = [];
    if (sequence === null || sequence === this.frames.at(-1)?.sequence) return;
    this.frames.push({ sequence, at_ms });
    this.forget(at_ms);
  }

  // Null: too little has come lately.
  perSecond(now_ms: number): number | null {
    this.forget(now_ms);
    const [first, last] = [this.frames[0], this.frames.at(-1)];
    if (!first || !last || last.at_ms - first.at_ms < least_ms) return null;
    return (1000 * (last.sequence - first.sequence)) / (last.at_ms - first.at_ms);
  }

  private forget(now_ms: number): void {
    this.frames = this.frames.filter(({ at_ms }) => now_ms - at_ms <= window_ms);
  }
}

const ahead_s = 60; // a clock that was just adjusted may put a beginning so far ahead
const longest_s = 24 * 3600; // a longer scan is a wrong clock

function elapsedText(started: Date | null, now: Date): string {
  if (!started) return '';
  const elapsed_s = (now.getTime() - started.getTime()) / 1000;
  return elapsed_s < -ahead_s || elapsed_s > longest_s ? '' : clockText(Math.max(0, elapsed_s), 0);
}

// "0:42 · 29.9 fps", with what of it is known. `now`: by the server's clock, as `started`.
export function paceText(
  { phase, paused, started }: Pick<LiveScan, 'phase' | 'paused' | 'started'>,
  perSecond: number | null,
  now: Date,
): string {
  if (phase !== 'running') return '';
  const rate = perSecond === null || paused ? '' : `${decimal(perSecond, 1)} fps`;
  return [elapsedText(started, now), rate].filter(Boolean).join(' · ');
}
