// The tags of a scan: marks in a row of the list, and a line on the scan's own page.
import type { LiveScan } from '../state/live_scan';
import type { Store } from '../state/store';
import { t } from '../texts/texts';
import { element, type Panel } from './dom';

export const tagMarks = (tags: readonly string[]): HTMLElement[] =>
  tags.map((tag) => element('span', { class: 'tag' }, tag));

// Follows the scan; there is no line without tags.
export function scanTags(scan: Store<LiveScan, never>): Panel {
  const marks = element('span', { class: 'tags' });
  const node = element(
    'p',
    { class: 'scan-tags' },
    element('span', { class: 'unseen' }, `${t.tags}: `),
    marks,
  );
  let shown: readonly string[] | null = null;
  const unsubscribe = scan.subscribe(({ tags }) => {
    if (tags === shown) return;
    shown = tags;
    node.hidden = tags.length === 0;
    marks.replaceChildren(...tagMarks(tags));
  });
  return { element: node, dispose: unsubscribe };
}
