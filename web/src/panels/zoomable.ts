// A picture that is enlarged and moved by two fingers, by dragging, by the wheel, by a double
// click, or by keys, with a button that shows all of it again.
import { wholePicture, zoomedBy, zoomedByKey, type Size, type Spot } from '../state/zoom';
import { buttonOf, element } from './dom';

const perWheel_px = 0.002; // of the logarithm
const doubleClick = 3;

export interface ZoomTexts {
  readonly back: string; // on the button
  readonly keys: string; // what the keys do, seen while they do it
}

// Returns the frame around it, which is as large as the picture is at first.
export function zoomable(picture: HTMLElement, { back, keys }: ZoomTexts): HTMLElement {
  const button = buttonOf(back, { class: 'button zoom-back' });
  const frame = element(
    'div',
    { class: 'zoom-frame', tabindex: 0, role: 'group', 'aria-label': keys },
    picture,
    button,
    element('span', { class: 'zoom-keys', 'aria-hidden': 'true' }, keys),
  );
  const fingers = new Map<number, Spot>();
  let zoom = wholePicture;
  const show = (next: typeof zoom): void => {
    zoom = next;
    picture.style.transform = `translate(${zoom.left_px}px, ${zoom.top_px}px) scale(${zoom.scale})`;
    frame.classList.toggle('zoomed', zoom.scale > 1);
    button.hidden = zoom.scale === 1;
  };
  const spotOf = ({ clientX, clientY }: MouseEvent): Spot => {
    const { left, top } = frame.getBoundingClientRect();
    return [clientX - left, clientY - top];
  };
  const size = (): Size => ({ width_px: frame.clientWidth, height_px: frame.clientHeight });
  const change = (by: number, from: Spot, to: Spot): void =>
    show(zoomedBy(zoom, by, from, to, size()));
  picture.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || fingers.size === 2) return;
    picture.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, spotOf(event));
  });
  picture.addEventListener('pointermove', (event) => {
    if (!fingers.has(event.pointerId)) return;
    const before = gripOf(fingers);
    fingers.set(event.pointerId, spotOf(event));
    const after = gripOf(fingers);
    change(
      before.wide_px > 0 && after.wide_px > 0 ? after.wide_px / before.wide_px : 1,
      before.middle,
      after.middle,
    );
  });
  for (const name of ['pointerup', 'pointercancel'] as const)
    picture.addEventListener(name, (event) => fingers.delete(event.pointerId));
  picture.addEventListener('dblclick', (event) => {
    if (zoom.scale > 1) show(wholePicture);
    else change(doubleClick, spotOf(event), spotOf(event));
  });
  picture.addEventListener('wheel', (event) => {
    event.preventDefault();
    change(Math.exp(-perWheel_px * event.deltaY), spotOf(event), spotOf(event));
  });
  frame.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return; // keys of the browser
    const next = zoomedByKey(zoom, event.key, size());
    if (!next) return;
    event.preventDefault();
    show(next);
  });
  button.addEventListener('click', () => {
    show(wholePicture);
    frame.focus({ preventScroll: true }); // the button goes
  });
  new ResizeObserver(() => show(wholePicture)).observe(frame); // also at first
  return frame;
}

// Where one finger is, or the middle of two and how far they are from each other.
function gripOf(fingers: ReadonlyMap<number, Spot>): {
  readonly middle: Spot;
  readonly wide_px: number;
} {
  const [first = [0, 0], second = first] = fingers.values();
  const middle: Spot = [(first[0] + second[0]) / 2, (first[1] + second[1]) / 2];
  return { middle, wide_px: Math.hypot(second[0] - first[0], second[1] - first[1]) };
}
