// What happens while the panel of frames is open: frames are chosen or played, their images are
// fetched and shown, and the scene shows where the camera was.
import { errorText } from '../connection/api';
import type { Pose } from '../connection/events';
import {
  fetchColor,
  fetchDepth,
  fetchFrames,
  fetchPath,
  posesOf,
  type DepthRange,
  type FrameList,
} from '../connection/frames';
import type { ScanScene } from '../scene/scene';
import { frameAfter, nextImage, OneAtATime, statusText, timeText, widened } from '../state/frames';
import { timestampText } from '../state/quantities';
import { sentence } from '../state/text';
import { t } from '../texts/texts';
import { setText } from './dom';
import type { FramesView } from './frames_view';

const tick_ms = 66; // two requests a frame: half of what a token may ask for in a second
const pause_ms = 1000; // after a request that did not work

interface DepthShown {
  readonly image: ImageBitmap;
  readonly shown: DepthRange;
  readonly measured: DepthRange;
}

interface Images {
  readonly color: ImageBitmap | string; // text: why there is none
  readonly depth: DepthShown | string;
}

export class LookingBack {
  private opened: AbortController | null = null;
  private recording: { readonly list: FrameList; readonly poses: readonly (Pose | null)[] } | null =
    null;
  private frame = 0;
  private drawn = -1; // the frame whose images are seen
  private range: DepthRange | null = null; // that the colours of depth span
  private playing: {
    readonly from: number;
    readonly since_ms: number;
    readonly timer: ReturnType<typeof setInterval>;
  } | null = null;
  private failed_ms = -Infinity;
  private readonly images: OneAtATime<Images>;

  constructor(
    private readonly scanId: string,
    private readonly token: string,
    private readonly scene: ScanScene,
    private readonly parts: FramesView,
  ) {
    const nothing = (): void => {}; // images say themselves what is wrong
    this.images = new OneAtATime(
      (frame, signal) => fetchImages(scanId, token, frame, { range: this.range, signal }),
      (frame, images) => this.got(frame, images),
      nothing,
    );
    parts.slider.addEventListener('input', () => this.choose(parts.slider.valueAsNumber));
    parts.before.addEventListener('click', () => this.step(-1));
    parts.after.addEventListener('click', () => this.step(1));
    parts.play.addEventListener('click', () => this.play());
    parts.through.addEventListener('click', () => this.pose && scene.lookThrough(this.pose));
  }

  // At that frame; null: where it was, or at the first one.
  open(frame: number | null): void {
    const mine = (this.opened = new AbortController());
    if (this.recording) return this.go(this.frame);
    this.say(t.loadingTheFrames);
    // A scan without results has no path.
    const path = fetchPath(this.scanId, this.token, mine.signal).catch(() => '');
    Promise.all([fetchFrames(this.scanId, this.token, mine.signal), path]).then(
      ([list, text]) => {
        if (this.opened === mine) this.take(list, posesOf(text, list.timestamps_s), frame);
      },
      (error: unknown) => {
        if (this.opened === mine) this.say(imageText(error));
      },
    );
  }

  close(): void {
    this.opened?.abort();
    this.opened = null;
    this.pause();
    this.images.stop();
    this.scene.showMoment(null);
  }

  step(by: 1 | -1): void {
    this.choose(this.frame + by);
  }

  // Or stops.
  play(): void {
    if (!this.recording) return;
    if (this.playing) return this.pause();
    const { list } = this.recording;
    const from =
      nextImage(list, this.frame, 1) === this.frame
        ? Math.max(0, nextImage(list, -1, 1))
        : this.frame; // again, at the end
    this.playing = {
      from,
      since_ms: performance.now(),
      timer: setInterval(() => this.tick(), tick_ms),
    };
    this.showPlay();
    if (from !== this.frame) this.go(from);
  }

  private get pose(): Pose | null {
    return this.recording?.poses[this.frame] ?? null;
  }

  private say(text: string): void {
    const { note, found, buttons } = this.parts;
    setText(note, text);
    note.hidden = text === '';
    found.hidden = buttons.hidden = text !== '';
  }

  private take(list: FrameList, poses: readonly (Pose | null)[], first: number | null): void {
    const count = list.timestamps_s.length;
    if (count === 0) return this.say(t.thereIsNoFrame);
    this.recording = { list, poses };
    // Where any frame has a reason, there is room for one beside all of them.
    this.parts.reason.hidden = list.reasons.every((reason) => reason === '');
    this.parts.slider.max = String(count - 1);
    this.say('');
    this.parts.slider.focus();
    this.go(first === null ? Math.max(0, nextImage(list, -1, 1)) : Math.min(count - 1, first));
  }

  private choose(frame: number): void {
    this.pause();
    if (this.recording)
      this.go(Math.min(this.recording.list.timestamps_s.length - 1, Math.max(0, frame)));
  }

  private go(frame: number): void {
    const { list } = this.recording!;
    const { color, depth, slider, number, time, status, reason, before, after, through } =
      this.parts;
    this.frame = frame;
    const last = list.timestamps_s.length - 1;
    const statusNow = statusText(list.statuses[frame]!);
    const reasonNow = sentence(list.reasons[frame]!);
    slider.value = String(frame);
    const saidOfIt = [statusNow.text, reasonNow].filter((part) => part !== '').join('. ');
    slider.setAttribute('aria-valuetext', t.frameOf(frame, last, timeText(list, frame), saidOfIt));
    setText(number, t.frameOfLast(frame, last));
    setText(time, timeText(list, frame));
    const at_s = list.timestamps_s[frame] ?? null;
    time.title = t.byTheCamerasClock(at_s === null ? t.noTime : timestampText(at_s));
    status.show(statusNow);
    setText(reason, reasonNow);
    before.disabled = frame === 0;
    after.disabled = frame === last;
    through.disabled = this.pose === null;
    if (at_s !== null) this.images.want(frame);
    else for (const image of [color, depth]) image.show(t.thereIsNoImage);
    if (!this.playing) this.place(); // else with its image
  }

  private got(frame: number, { color, depth }: Images): void {
    const { parts } = this;
    if (typeof color === 'string' || typeof depth === 'string') this.failed_ms = performance.now();
    this.drawn = frame;
    parts.color.show(color);
    parts.depth.show(typeof depth === 'string' ? depth : depth.image);
    parts.scale.element.hidden = typeof depth === 'string' || depth.shown.to_mm === 0;
    if (typeof depth !== 'string') {
      parts.scale.show(depth.shown);
      this.range = widened(this.range, depth.measured);
    }
    if (frame === this.frame) this.place();
  }

  private place(): void {
    const { color } = this.parts;
    this.scene.showMoment(
      this.pose && {
        worldFromCamera: this.pose,
        image: this.drawn === this.frame && color.isThere() ? color.canvas : null,
      },
    );
  }

  private tick(): void {
    if (!this.playing || !this.recording) return;
    const { list } = this.recording;
    const now_ms = performance.now();
    const to = frameAfter(list, this.playing.from, (now_ms - this.playing.since_ms) / 1000);
    // Frames are left out where the link is slow.
    if (this.images.isBusy || now_ms - this.failed_ms < pause_ms) return;
    if (to !== this.frame) this.go(to);
    else if (nextImage(list, to, 1) === to) this.pause(); // the end
  }

  private pause(): void {
    if (this.playing) clearInterval(this.playing.timer);
    this.playing = null;
    this.showPlay();
  }

  private showPlay(): void {
    const { play } = this.parts;
    setText(play, this.playing ? t.pause : t.play);
    play.setAttribute('aria-label', this.playing ? t.pause : t.play);
  }
}

interface Wanted {
  readonly range: DepthRange | null;
  readonly signal: AbortSignal;
}

// Both, or why one of them cannot be had. Fails only when nobody wants them any more.
async function fetchImages(
  scanId: string,
  token: string,
  frame: number,
  { range, signal }: Wanted,
): Promise<Images> {
  const color = fetchColor(scanId, token, frame, signal).then((blob) => createImageBitmap(blob));
  const depth = fetchDepth(scanId, token, frame, range, signal).then(
    async ({ image, ...ranges }) => ({
      image: await createImageBitmap(image),
      ...ranges,
    }),
  );
  const [shown, measured] = await Promise.all([color.catch(imageText), depth.catch(imageText)]);
  signal.throwIfAborted();
  return { color: shown, depth: measured };
}

const imageText = (error: unknown): string => errorText(error, t.thisImageCannotBeRead);
