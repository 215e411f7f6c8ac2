// Asks for one click on the floor.
import { element, type Panel } from './dom';

const farthest_px = 6; // a click that moves further turns the view

export interface FloorPicker extends Panel {
  begin(): void;
}

// `choose` is told where, in pixels of the page; false: nothing is there.
export function floorPicker(canvas: HTMLCanvasElement, choose: (x_px: number, y_px: number) => boolean): FloorPicker {
  const cancel = element('button', { type: 'button', class: 'button' }, 'Cancel');
  const node = element('div', { class: 'card asking', role: 'status' }, element('span', {}, 'Click on the floor, or on anything that lies level.'), cancel);
  node.hidden = true;
  let down: readonly [number, number] | null = null;
  const ask = (on: boolean): void => {
    node.hidden = !on;
    canvas.classList.toggle('picking', on);
  };
  const onDown = (event: PointerEvent): void => {
    down = [event.clientX, event.clientY];
  };
  const onClick = (event: MouseEvent): void => {
    if (node.hidden || !down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > farthest_px) return;
    if (choose(event.clientX, event.clientY)) ask(false);
  };
  const onKey = (event: KeyboardEvent): void => {
    if (event.key === 'Escape') ask(false);
  };
  cancel.addEventListener('click', () => ask(false));
  canvas.addEventListener('pointerdown', onDown);
  canvas.addEventListener('click', onClick);
  document.addEventListener('keydown', onKey);
  return {
    element: node,
    begin: () => ask(true),
    dispose() {
      document.removeEventListener('keydown', onKey);
    },
  };
}
