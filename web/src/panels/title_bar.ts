// The bar at the top of a scan's page: its title and phase, and what whoever
// looks may do with the scan.
import { errorText } from '../connection/api';
import { fetchAccess, noAccess, pauseScan, stopScan, type Access } from '../connection/scans';
import { hasEnded, type LiveScan, type LiveScanEvent } from '../state/live_scan';
import type { Store } from '../state/store';
import { phaseText } from '../state/text';
import { t } from '../texts/texts';
import { chooseCompared } from './compare_chooser';
import { element, setText, type Panel } from './dom';
import { downloadMenu } from './download_menu';
import { showEmbedding } from './embed_dialog';
import { statusMark } from './mark';
import { menu, type MenuItem } from './menu';
import { showFloorPlan } from './plan_dialog';
import { changeTags, deleteSoon, rename } from './scan_actions';
import { scanPace } from './scan_pace';
import { shareButton } from './share_button';

type ScanStore = Store<LiveScan, LiveScanEvent>;

export interface Viewing {
  readonly actions: () => MenuItem[]; // what else the menu has
  readonly link: () => string; // how the scan is looked at, as fields of an address
}

export function titleBar(scan: ScanStore, token: string, viewing: Viewing): Panel {
  const title = element('h1');
  const phase = statusMark();
  const pace = scanPace(scan);
  const downloads = downloadMenu(scan, token);
  const problem = element('span', { class: 'problem', role: 'alert' });
  const share = shareButton(scan.get().scanId, token, problem, viewing.link);
  let access = noAccess;
  const shareItem: MenuItem = {
    label: t.share,
    phoneOnly: true,
    do: () => share.querySelector('button')?.click(),
  };
  const embed = (): void =>
    showEmbedding(scan.get().scanId, scan.get().title, token, viewing.link());
  const more = menu(t.more, () => [
    ...(access.scan ? [shareItem] : []),
    ...(access.scan && access.embedding ? [{ label: t.embed, do: embed }] : []),
    ...viewing.actions(),
    ...scanActions(scan, token, access, problem),
  ]);
  const node = element(
    'header',
    { class: 'title-bar' },
    element(
      'a',
      { class: 'back', href: '#/', 'aria-label': t.allScans },
      element('span', { 'aria-hidden': 'true' }, '←'),
      element('span', { class: 'back-words' }, ' Scans'),
    ),
    element(
      'div',
      { class: 'heading' },
      title,
      element('div', { class: 'phase' }, phase.element, pace.element),
    ),
    element('span', { class: 'space' }),
    problem,
    share,
    downloads.element,
    more.element,
  );
  share.hidden = true;
  fetchAccess(token).then(
    (told) => {
      access = told;
      share.hidden = !(told.view && told.scan);
    },
    () => {}, // the connection of the scan says what is wrong
  );
  const unsubscribe = scan.subscribe((state) => {
    setText(title, state.title || t.scan);
    title.title = state.title;
    document.title = state.title ? `${state.title} – Hermite` : 'Hermite';
    phase.show(phaseText(state.phase, state.paused));
    phase.element.hidden = state.phase === 'unknown';
  });
  return {
    element: node,
    dispose() {
      unsubscribe();
      pace.dispose();
      downloads.dispose();
      more.dispose();
    },
  };
}

// What whoever looks may do with the scan.
function scanActions(scan: ScanStore, token: string, access: Access, problem: Element): MenuItem[] {
  const { scanId, title, tags, phase, paused, canPause } = scan.get();
  const refused = (error: unknown): void => setText(problem, errorText(error));
  const stop = (): void => void stopScan(scanId, token).catch(refused);
  const pause = (): void => void pauseScan(scanId, !paused, token).catch(refused);
  const remove = (): void => {
    deleteSoon(scanId, title, token);
    location.hash = '#/';
  };
  const ended = hasEnded(phase);
  return [
    ...(access.scan
      ? [
          {
            label: t.rename,
            do: () =>
              rename(scanId, title, token, (wanted) =>
                scan.dispatch({ kind: 'renamed', title: wanted }),
              ),
          },
          {
            label: t.tags,
            do: () =>
              changeTags(scanId, tags, token, (as) => scan.dispatch({ kind: 'listed', as })),
          },
        ]
      : []),
    ...(access.scan && canPause
      ? [{ label: paused ? t.goOnScanning : t.pauseTheScan, do: pause }]
      : []),
    ...(access.scan && phase === 'running' ? [{ label: t.stopAndKeep, do: stop }] : []),
    ...(access.view && ended
      ? [{ label: t.floorPlan, do: () => showFloorPlan(scanId, title, token) }]
      : []),
    ...(access.view && !access.shared && ended
      ? [{ label: t.compareWith, do: () => chooseCompared(scanId, token) }]
      : []),
    ...(access.admin && ended ? [{ label: t.delete, bad: true, do: remove }] : []),
  ];
}
