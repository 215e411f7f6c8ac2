// Asks for one click on the floor.
import { t } from '../texts/texts';
import { buttonOf, element, type Panel } from './dom';
import { onTap } from './tap';

export interface FloorPicker extends Panel {
  begin(): void;
}

// `choose` is told where, in pixels of the page; false: nothing is there.
export function floorPicker(
  canvas: HTMLCanvasElement,
  choose: (x_px: number, y_px: number) => boolean,
): FloorPicker {
  const cancel = buttonOf(t.cancel);
  const node = element(
    'div',
    { class: 'card asking', role: 'status' },
    element('span', {}, t.clickOnTheFloorOrOn),
    cancel,
  );
  node.hidden = true;
  const ask = (on: boolean): void => {
    node.hidden = !on;
    canvas.classList.toggle('picking', on);
  };
  const onKey = (event: KeyboardEvent): void => {
    if (event.key === 'Escape') ask(false);
  };
  cancel.addEventListener('click', () => ask(false));
  onTap(canvas, (x_px, y_px) => {
    const isAsking = !node.hidden;
    if (isAsking && choose(x_px, y_px)) ask(false);
    return isAsking;
  });
  document.addEventListener('keydown', onKey);
  return {
    element: node,
    begin: () => ask(true),
    dispose() {
      document.removeEventListener('keydown', onKey);
    },
  };
}
