// The tags of a scan: marks in a row of the list, and on the scan's own page.
import type { LiveScan } from '../state/live_scan';
import type { Store } from '../state/store';
import { t } from '../texts/texts';
import { element, type Panel } from './dom';
import { hintAtMore } from './scroll_hint';

export const tagMarks = (tags: readonly string[]): HTMLElement[] =>
  tags.map((tag) => element('span', { class: 'tag' }, tag));

// Follows the scan; there is nothing without tags. Those that have no room are scrolled to.
export function scanTags(scan: Store<LiveScan, never>): Panel {
  const node = element('div', { class: 'tags scan-tags', role: 'group', 'aria-label': t.tags });
  const sizes = new ResizeObserver(() => {
    node.tabIndex = node.scrollHeight > node.clientHeight ? 0 : -1; // for keys
  });
  sizes.observe(node);
  const stopHint = hintAtMore(node);
  let shown: readonly string[] | null = null;
  const unsubscribe = scan.subscribe(({ tags }) => {
    if (tags === shown) return;
    shown = tags;
    node.hidden = tags.length === 0;
    node.replaceChildren(...tagMarks(tags));
  });
  return {
    element: node,
    dispose() {
      unsubscribe();
      sizes.disconnect();
      stopHint();
    },
  };
}
