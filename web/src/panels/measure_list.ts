// The measurements that are kept with the scan, oldest first. However many they are, the panel
// stays as high as it is: the list scrolls, and shows the newest.
import type { KeptMeasurement } from '../connection/measurements';
import { hasNewest } from '../state/measuring';
import { t } from '../texts/texts';
import { buttonOf, element, type Panel } from './dom';
import type { KeptMeasurements } from './kept_measurements';
import { hintAtMore } from './scroll_hint';

export type Changes = Pick<KeptMeasurements, 'keep' | 'remove'>;

export interface MeasureList extends Panel {
  // `changes`: null for whoever may only look.
  show(kept: readonly KeptMeasurement[], changes: Changes | null): void;
}

export function measureList(): MeasureList {
  const node = element('ul', {
    class: 'measure-list',
    tabindex: 0, // it can be scrolled by keys, also where no row has a button
    'aria-label': t.keptMeasurements,
  });
  let shown: readonly KeptMeasurement[] = [];
  let shownChanges: Changes | null = null;
  return {
    element: node,
    show(kept, changes) {
      if (kept === shown && changes === shownChanges) return;
      const isNewer = hasNewest(shown, kept);
      const hadFocus = node.contains(document.activeElement);
      [shown, shownChanges] = [kept, changes];
      node.hidden = kept.length === 0;
      node.replaceChildren(...kept.map((one) => rowOf(one, changes)));
      if (isNewer) node.scrollTop = node.scrollHeight;
      if (hadFocus) node.focus({ preventScroll: true }); // its button has gone
    },
    dispose: hintAtMore(node),
  };
}

function rowOf(one: KeptMeasurement, changes: Changes | null): HTMLElement {
  const row = element(
    'li',
    {},
    element(
      'div',
      {},
      element('span', { class: 'measure-name' }, one.name),
      element('span', {}, one.words),
    ),
  );
  if (!changes) return row;
  const button = buttonOf('×', { 'aria-label': t.removeNamed(one.name) });
  button.addEventListener('click', () => changes.remove(one));
  row.append(button);
  return row;
}
