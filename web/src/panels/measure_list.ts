// The measurements that are kept with the scan, oldest first. However many they are, the panel
// stays as high as it is: the list scrolls, and shows the newest.
import type { KeptMeasurement } from '../connection/measurements';
import { hasNewest } from '../state/measuring';
import { t } from '../texts/texts';
import { buttonOf, element, type Panel } from './dom';
import type { KeptMeasurements } from './kept_measurements';
import { hintAtMore, isAtEnd } from './scroll_hint';

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
  const stay = stayAtEnd(node); // before the hint looks
  const stopHint = hintAtMore(node);
  let shown: readonly KeptMeasurement[] = [];
  let shownChanges: Changes | null = null;
  return {
    element: node,
    show(kept, changes) {
      if (kept === shown && changes === shownChanges) return;
      // Rows get higher when it is known that they may be removed.
      const toEnd = hasNewest(shown, kept) || isAtEnd(node);
      const hadFocus = node.contains(document.activeElement);
      [shown, shownChanges] = [kept, changes];
      node.hidden = kept.length === 0;
      node.replaceChildren(...kept.map((one) => rowOf(one, changes)));
      if (toEnd) stay.goThere();
      if (hadFocus) node.focus({ preventScroll: true }); // its button has gone
    },
    dispose() {
      stay.stop();
      stopHint();
    },
  };
}

// Who sees the end of what scrolls, still does when it gets lower.
function stayAtEnd(scrolled: HTMLElement): { goThere(): void; stop(): void } {
  let wasAtEnd = true;
  const goThere = (): void => {
    wasAtEnd = true;
    scrolled.scrollTop = scrolled.scrollHeight;
  };
  const sizes = new ResizeObserver(() => wasAtEnd && goThere());
  sizes.observe(scrolled);
  scrolled.addEventListener('scroll', () => (wasAtEnd = isAtEnd(scrolled)), { passive: true });
  return { goThere, stop: () => sizes.disconnect() };
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
