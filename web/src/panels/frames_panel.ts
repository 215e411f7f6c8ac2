// Looking back: a slider over all frames of a scan that has ended, with the images of that moment
// and where the camera was.
import { fetchAccess } from '../connection/scans';
import type { ScanScene } from '../scene/scene';
import { hasEnded, type LiveScan } from '../state/live_scan';
import type { Store } from '../state/store';
import { t } from '../texts/texts';
import { buttonOf, type Panel } from './dom';
import { framesView } from './frames_view';
import { LookingBack } from './looking_back';

export interface FramesPanel extends Panel {
  readonly button: HTMLElement; // opens and closes it; hidden where there are no frames to be seen
  toggle(): void; // the same
  close(): void;
}

interface World {
  readonly scene: ScanScene;
  readonly scan: Store<LiveScan, never>;
  readonly token: string;
  readonly first: number | null; // the frame that the address names: it is opened there
  readonly opened: () => void; // it stands where others may stand
}

export function framesPanel({ scene, scan, token, first, opened }: World): FramesPanel {
  const { scanId } = scan.get();
  const parts = framesView();
  const button = buttonOf(t.frames, {
    class: 'button frames-button',
    title: t.whatTheCameraHasSeenFrame,
    'aria-pressed': 'false',
  });
  const back = new LookingBack(scanId, token, scene, parts);
  let wanted = first;
  const open = (on: boolean): void => {
    const hadFocus = parts.node.contains(document.activeElement);
    parts.node.hidden = !on;
    parts.node.parentElement?.classList.toggle('looking-back', on);
    button.setAttribute('aria-pressed', String(on));
    if (!on) {
      back.close();
      if (hadFocus) button.focus();
      return;
    }
    opened();
    back.open(wanted);
    wanted = null;
    parts.slider.focus();
  };
  const close = (): void => {
    if (!parts.node.hidden) open(false);
  };
  const toggle = (): void => {
    if (!button.hidden) open(parts.node.hidden);
  };
  let allowed = false;
  const showButton = (): void => {
    const { phase, framesReceived } = scan.get();
    // No camera has seen what was imported.
    button.hidden = !hasEnded(phase) || framesReceived === 0 || !allowed;
    if (button.hidden) close();
    else if (wanted !== null && parts.node.hidden) open(true);
  };
  const onKey = (event: KeyboardEvent): void => {
    if (event.key === 'Escape' && !event.defaultPrevented && !document.querySelector('dialog'))
      close();
  };
  parts.node.hidden = true;
  button.addEventListener('click', toggle);
  parts.done.addEventListener('click', close);
  parts.node.addEventListener('keydown', (event) => keyInside(event, back));
  document.addEventListener('keydown', onKey);
  whenAllowed(token, () => {
    allowed = true;
    showButton();
  });
  const unsubscribe = scan.subscribe(showButton);
  return {
    element: parts.node,
    button,
    toggle,
    close,
    dispose() {
      document.removeEventListener('keydown', onKey);
      unsubscribe();
      back.close();
    },
  };
}

// A share link is for the model.
function whenAllowed(token: string, then: () => void): void {
  fetchAccess(token).then(
    ({ view, shared }) => view && !shared && then(),
    () => {}, // the connection of the scan says what is wrong
  );
}

function keyInside(event: KeyboardEvent, back: LookingBack): void {
  const { target, key } = event;
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const onSlider = target instanceof HTMLInputElement;
  if (key === ' ' && onSlider) back.play();
  else if (key === 'ArrowLeft' && !onSlider) back.step(-1);
  else if (key === 'ArrowRight' && !onSlider) back.step(1);
  else return;
  event.preventDefault();
  event.stopPropagation(); // one key, one thing
}
