// A picture that is enlarged and moved by two fingers, by dragging, by the wheel, or by a double
// click, with a button that shows all of it again.
import { wholePicture, zoomedBy, type Spot } from '../state/zoom';
import { buttonOf, element } from './dom';

const perWheel_px = 0.002; // of the logarithm
const doubleClick = 3;

// Returns the frame around it, which is as large as the picture is at first.
export function zoomable(picture: HTMLElement, back: string): HTMLElement {
  const button = buttonOf(back, { class: 'button zoom-back' });
  const frame = element('div', { class: 'zoom-frame' }, picture, button);
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
  const change = (by: number, from: Spot, to: Spot): void =>
    show(
      zoomedBy(zoom, by, from, to, { width_px: frame.clientWidth, height_px: frame.clientHeight }),
    );
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
  button.addEventListener('click', () => show(wholePicture));
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
