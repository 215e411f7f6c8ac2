// What the camera of a running scan sees: its newest colour and depth image; while it is lost,
// beside that the last view that it should go back to.
import { errorText } from '../connection/api';
import type { ScanEvent } from '../connection/events';
import { fetchColor, fetchDepth, fetchLiveColor, type DepthRange } from '../connection/frames';
import { fetchAccess } from '../connection/scans';
import type { ScanScene } from '../scene/scene';
import { BehindMeter, behindParts, behindText, silenceText, type Behind } from '../state/behind';
import { widened } from '../state/frames';
import type { LiveScan, WayBack } from '../state/live_scan';
import { liveIsWanted, storeLive } from '../state/live_choice';
import { metresText } from '../state/quantities';
import type { Store } from '../state/store';
import { asksForSurface, type ViewOptions } from '../state/view_options';
import { lostText, sentence, trackingText, wayBackCaption } from '../state/text';
import { t } from '../texts/texts';
import { buttonOf, element, setText, type Panel } from './dom';
import { frameImage } from './frame_image';
import { statusMark } from './mark';
import { ofThisBrowser } from '../state/storages';

export interface LivePanel extends Panel {
  readonly button: HTMLElement; // opens and closes it; hidden where there are no images to be seen
  toggle(): void; // the same
  onEvent(event: ScanEvent): void; // after the scene
}

interface World {
  readonly scene: ScanScene;
  readonly scan: Store<LiveScan, never>;
  readonly options: Store<ViewOptions, Partial<ViewOptions>>;
  readonly token: string;
  readonly opened: () => void; // it stands where others may stand
}

const tick_ms = 100;
// The pause between images is at least this, and as long as the last ones took: half of a
// slow link is for the model.
const least_ms = 500;

export function livePanel({ scene, scan, options, token, opened }: World): LivePanel {
  const parts = partsOf();
  const { node, done, there } = parts;
  const button = buttonOf(t.camera, {
    class: 'button live-button',
    title: t.whatTheCameraSeesL,
    'aria-pressed': 'false',
  });
  const images = new LiveImages({ scene, scan, options, token }, parts);
  let wanted = liveIsWanted(ofThisBrowser);
  let allowed = false;
  const show = (): void => {
    const { phase, wayBack, connection } = scan.get();
    const running = phase === 'running' && connection !== 'closed';
    button.hidden = !running || !allowed;
    const on = running && ((wanted && allowed) || wayBack !== null);
    node.hidden = !on;
    there.hidden = !allowed;
    done.hidden = wayBack !== null;
    button.setAttribute('aria-pressed', String(on));
    node.parentElement?.classList.toggle('watching', on);
    images.show(on, allowed);
  };
  const choose = (on: boolean): void => {
    const hadFocus = node.contains(document.activeElement);
    wanted = on;
    storeLive(ofThisBrowser, on);
    if (on) opened();
    show();
    if (hadFocus && !on) button.focus();
  };
  const toggle = (): void => {
    if (!button.hidden) choose(!node.checkVisibility()); // another tool may stand in its place
  };
  button.addEventListener('click', toggle);
  done.addEventListener('click', () => choose(false));
  parts.there.addEventListener('click', () => images.lookThere());
  // A share link is for the model.
  fetchAccess(token).then(
    ({ view, shared }) => {
      allowed = view && !shared;
      show();
    },
    () => {}, // the connection of the scan says what is wrong
  );
  node.hidden = true;
  const unsubscribe = scan.subscribe(show);
  return {
    element: node,
    button,
    toggle,
    onEvent: (event) => images.onEvent(event),
    dispose() {
      unsubscribe();
      images.show(false, false);
    },
  };
}

type Parts = ReturnType<typeof partsOf>;

function partsOf() {
  const [near, far] = [element('span'), element('span')];
  const scale = element(
    'span',
    { class: 'depth-scale' },
    near,
    element('span', { class: 'depth-colors', 'aria-hidden': 'true' }),
    far,
  );
  const color = frameImage(t.whatTheCameraSees, t.camera);
  const depth = frameImage(t.itsDepthRedIsNearBlue, t.depth, scale);
  const ago = element('span');
  const back = frameImage(t.theViewToGoBackTo, ago);
  back.element.classList.add('way-back');
  const lost = element('p', { class: 'live-lost', role: 'alert' });
  const why = element('p', { class: 'live-why' }); // not read aloud whenever it changes
  const images = element(
    'div',
    { class: 'frame-pictures' },
    back.element,
    color.element,
    depth.element,
  );
  const tracking = statusMark(); // on a phone, where the status has no room beside this
  tracking.element.classList.add('live-tracking');
  const [behind, behindWhy] = [element('summary'), element('p')];
  const delays = element('details', { class: 'live-behind' }, behind, behindWhy);
  const there = buttonOf(t.lookFromThere, { title: t.movesTheViewToWhereThe });
  const done = buttonOf(t.close, { 'aria-label': t.closeTheCamerasImages });
  const node = element(
    'section',
    { class: 'card frames live', 'aria-label': t.camera },
    tracking.element,
    lost,
    why,
    images,
    element('div', { class: 'live-foot' }, delays, there, done),
  );
  return {
    node,
    tracking,
    lost,
    images,
    color,
    depth,
    back,
    ago,
    why,
    near,
    far,
    scale,
    delays,
    behind,
    behindWhy,
    there,
    done,
  };
}

type LiveWorld = Omit<World, 'opened'>;

// Fetches the images while somebody sees them.
class LiveImages {
  private timer: ReturnType<typeof setInterval> | undefined;
  private onItsWay: AbortController | null = null;
  private allowed = false;
  private drawn: number | null = null; // the frame whose images are seen
  private drawnBack: number | null = null;
  private next_ms = 0; // not before that
  private range: DepthRange | null = null; // that the colours of depth span
  private newestFrame: { readonly sequence: number; readonly came_ms: number } | null = null;
  private behind: Behind | null = null;
  private readonly meter = new BehindMeter();

  constructor(
    private readonly world: LiveWorld,
    private readonly parts: Parts,
  ) {}

  show(on: boolean, allowed: boolean): void {
    this.allowed = allowed;
    this.showLost();
    if (on === (this.timer !== undefined)) return;
    clearInterval(this.timer);
    this.timer = on ? setInterval(() => this.tick(), tick_ms) : undefined;
    if (on) return this.tick();
    this.onItsWay?.abort();
    this.onItsWay = null;
  }

  onEvent(event: ScanEvent): void {
    if (event.kind === 'frame')
      this.newestFrame = { sequence: event.sequence, came_ms: performance.now() };
    // Perhaps the scan is built again.
    if (event.kind === 'welcome') this.drawn = this.drawnBack = this.newestFrame = null;
    if (
      (event.kind !== 'chunk' && event.kind !== 'meshChunk') ||
      event.waited_ms === undefined ||
      document.hidden
    )
      return;
    const [came_ms, waited_ms] = [performance.now(), event.waited_ms];
    this.world.scene.images.whenDrawn((drawn_ms) =>
      this.meter.modelDrawn(waited_ms + drawn_ms - came_ms),
    );
  }

  lookThere(): void {
    const { wayBack } = this.world.scan.get();
    if (!wayBack) return;
    this.world.options.dispatch({ follow: false });
    this.world.scene.lookThrough(wayBack.worldFromCamera);
  }

  private showLost(): void {
    const { scene, scan } = this.world;
    const { tracking, lost, why, back, depth, color, there, ago, images, node } = this.parts;
    const state = scan.get();
    tracking.show(trackingText(state));
    const { wayBack } = state;
    const isLost = wayBack !== null && state.phase === 'running';
    node.classList.toggle('lost', isLost);
    lost.hidden = why.hidden = !isLost;
    tracking.element.hidden = isLost;
    images.hidden = !this.allowed;
    back.element.hidden = !isLost;
    depth.element.hidden = isLost;
    there.hidden = !isLost;
    if (isLost) {
      setText(lost, lostText(this.allowed));
      setText(why, sentence(state.trackingReason));
      if (wayBack.sequence !== this.drawnBack) back.show(t.itsImageIsOnItsWay);
      setText(ago, wayBackCaption(state));
    } else if (this.drawnBack !== null) {
      scene.showMoment(null);
      this.drawnBack = null;
    }
    color.element.classList.toggle('is-lost', isLost);
  }

  private tick(): void {
    const silent = this.newestFrame
      ? silenceText(performance.now() - this.newestFrame.came_ms)
      : '';
    this.showBehind(silent);
    if (
      !this.allowed ||
      document.hidden ||
      !this.parts.node.checkVisibility() ||
      this.onItsWay ||
      performance.now() < this.next_ms
    )
      return;
    const { wayBack, connection, sequence } = this.world.scan.get();
    if (connection !== 'open') return;
    if (wayBack && wayBack.sequence !== this.drawnBack)
      void this.alone((signal) => this.fetchBack(wayBack, signal));
    else if (sequence !== null && sequence !== this.drawn)
      void this.alone((signal) => this.fetchNow(sequence, signal));
  }

  private showBehind(silent: string): void {
    const { delays, behind, behindWhy } = this.parts;
    const text = silent || (this.behind ? behindText(this.behind) : '');
    delays.classList.toggle('unknown', text === ''); // keeps its place
    setText(behind, text);
    setText(behindWhy, this.behind ? behindParts(this.behind) : '');
  }

  // One at a time; what fails is tried again with a newer frame.
  private async alone(fetch: (signal: AbortSignal) => Promise<void>): Promise<void> {
    const mine = (this.onItsWay = new AbortController());
    const began_ms = performance.now();
    await fetch(mine.signal).catch((error: unknown) => {
      if (this.onItsWay === mine && this.drawn === null)
        this.parts.color.show(errorText(error, t.thisImageCannotBeRead));
    });
    if (this.onItsWay !== mine) return;
    this.onItsWay = null;
    const took_ms = performance.now() - began_ms;
    this.next_ms = began_ms + Math.max(least_ms, 2 * took_ms);
  }

  private async fetchNow(sequence: number, signal: AbortSignal): Promise<void> {
    const { scan, token, options } = this.world;
    const { scanId, wayBack } = scan.get();
    const { color, depth, near, far, scale } = this.parts;
    const asked_ms = performance.now();
    const live = await fetchLiveColor(scanId, token, sequence, signal);
    if (!live) return;
    const shown = wayBack ? null : await fetchDepth(scanId, token, sequence, this.range, signal);
    const image = await createImageBitmap(live.image);
    const depthImage = shown && (await createImageBitmap(shown.image));
    if (signal.aborted) return;
    this.drawn = sequence;
    color.show(image);
    if (shown && depthImage) {
      depth.show(depthImage);
      this.range = widened(this.range, shown.measured);
      scale.hidden = shown.shown.to_mm === 0;
      setText(near, metresText(shown.shown.from_mm / 1000, 1));
      setText(far, metresText(shown.shown.to_mm / 1000, 1));
    }
    const { triangles, surfaceHasConfidences } = scan.get();
    const showsSurface =
      triangles > 0 && asksForSurface(options.get(), surfaceHasConfidences === true);
    requestAnimationFrame(() => {
      this.behind = this.meter.imageDrawn(
        live,
        { asked_ms, answered_ms: live.answered_ms },
        performance.now(),
        showsSurface,
      );
    });
  }

  private async fetchBack(
    { sequence, worldFromCamera }: WayBack,
    signal: AbortSignal,
  ): Promise<void> {
    const { scan, token, scene } = this.world;
    const { back } = this.parts;
    const image = await createImageBitmap(
      await fetchColor(scan.get().scanId, token, sequence, signal),
    );
    if (signal.aborted || scan.get().wayBack?.sequence !== sequence) return;
    this.drawnBack = sequence;
    back.show(image);
    scene.showMoment({ worldFromCamera, image: back.canvas });
  }
}
