// All that stands before a scan in a page of another site: its title, which
// leads to all of the viewer, and its tags.
import type { LiveScan, LiveScanEvent } from '../state/live_scan';
import type { Store } from '../state/store';
import { t } from '../texts/texts';
import { element, setText, type Panel } from './dom';
import { scanTags } from './scan_tags';

// `link`: how the scan is looked at, as fields of an address.
export function embeddedBar(
  scan: Store<LiveScan, LiveScanEvent>,
  token: string,
  link: () => string,
): Panel {
  const title = element('a', {
    class: 'embedded-bar',
    target: '_blank',
    rel: 'noopener',
    title: t.openInHermite,
  });
  const write = (): void => {
    const fields = [
      `#share=${encodeURIComponent(token)}&scan=${encodeURIComponent(scan.get().scanId)}`,
      link(),
    ].filter(Boolean);
    title.setAttribute('href', location.pathname + fields.join('&'));
  };
  const unsubscribe = scan.subscribe((state) => {
    setText(title, `${state.title || t.scan} ↗`);
    write();
  });
  const tags = scanTags(scan);
  return {
    element: element('div', { class: 'embedded-head' }, title, tags.element),
    dispose() {
      unsubscribe();
      tags.dispose();
    },
  };
}
