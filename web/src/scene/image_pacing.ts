// When the next image of a scan is drawn: as soon as something has changed, or after a pause where
// images are slow and change by themselves.

const longestStep_ms = 400; // after an idle time nothing leaps
const fpsWindow_ms = 2000;
const slowImage_ms = 60;
const longestPause_ms = 1000;
const mostTimes_count = 480; // of drawn images, before the old ones are forgotten

// What an image leaves to the next one: somebody's hand moves it, it moves
// by itself, or it may rest.
export type Motion = 'byHand' | 'byItself' | 'none';

export class ImagePacing {
  private frameRequest = 0;
  private pause: ReturnType<typeof setTimeout> | undefined;
  private requested_ms = 0;
  private image_ms = 0; // how long an image takes lately, from asking for it to drawing it
  private drawn_ms: number[] = [];
  private last_ms = 0;
  private onDrawn: ((drawn_ms: number) => void) | null = null;
  private disposed = false;

  // `draw` draws one image, `elapsed_ms` after the last one.
  constructor(private readonly draw: (elapsed_ms: number, now_ms: number) => Motion) {}

  request(): void {
    clearTimeout(this.pause);
    // Forgotten first: a pause that has run out must not look like one that still runs.
    this.pause = undefined;
    if (this.frameRequest !== 0 || this.disposed) return;
    this.requested_ms = performance.now();
    this.frameRequest = requestAnimationFrame((now_ms) => this.onFrame(now_ms));
  }

  // For what changes by itself. Where images are slow (no graphics card), a pause leaves the
  // processor to decoding and to the viewer's own hand.
  requestInTime(): void {
    if (this.image_ms < slowImage_ms) this.request();
    else
      this.pause ??= setTimeout(() => this.request(), Math.min(longestPause_ms, 3 * this.image_ms));
  }

  // `then` is called once, with the time at which the next image is done. Only the
  // first one that waits is kept.
  whenDrawn(then: (drawn_ms: number) => void): void {
    this.onDrawn ??= then;
  }

  // Nothing moves, and all that has come is drawn.
  get isResting(): boolean {
    return this.frameRequest === 0 && this.pause === undefined;
  }

  // Images a second, over the last two; 0 while nothing changes.
  framesPerSecond(): number {
    const since_ms = performance.now() - fpsWindow_ms;
    this.drawn_ms = this.drawn_ms.filter((time) => time >= since_ms);
    return Math.ceil(this.drawn_ms.length / (fpsWindow_ms / 1000));
  }

  dispose(): void {
    this.disposed = true;
    cancelAnimationFrame(this.frameRequest);
    clearTimeout(this.pause);
  }

  private onFrame(now_ms: number): void {
    this.frameRequest = 0;
    this.image_ms = 0.7 * this.image_ms + 0.3 * (performance.now() - this.requested_ms);
    const elapsed_ms = Math.min(longestStep_ms, Math.max(0, now_ms - this.last_ms));
    this.last_ms = now_ms;
    const motion = this.draw(elapsed_ms, now_ms);
    this.drawn_ms.push(performance.now());
    const { onDrawn } = this;
    this.onDrawn = null;
    onDrawn?.(performance.now());
    if (this.drawn_ms.length > mostTimes_count) this.framesPerSecond(); // forgets the old ones
    if (motion === 'byHand') this.request();
    else if (motion === 'byItself') this.requestInTime();
  }
}
