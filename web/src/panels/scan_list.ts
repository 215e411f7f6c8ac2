// The rows of the list of scans: searched and sorted, and each with what
// whoever looks may do with it.
import { errorText, type ScanSummary } from '../connection/api';
import { noAccess, stopScan, type Access } from '../connection/scans';
import { serverClock } from '../connection/server_clock';
import { thumbnails } from '../connection/thumbnails';
import { hashOf } from '../state/route';
import { ago, framesText, phaseText } from '../state/text';
import { t } from '../texts/texts';
import { buttonOf, element, type Panel } from './dom';
import { statusMark } from './mark';
import { menu, type Menu, type MenuItem } from './menu';
import { changeTags, deleteSoon, onTrashChange, rename, trash } from './scan_actions';
import { scanFinder } from './scan_finder';
import { tagMarks } from './scan_tags';
import { thumbnailViews } from './scan_thumbnail';

export interface ScanListWorld {
  token(): string;
  changed(): void; // something was done that the server's list will have
  older(): Promise<void>; // somebody wants more of them
  say(text: string): void;
}

export interface ScanList extends Panel {
  show(scans: readonly ScanSummary[], more: boolean, access: Access): void;
  showInstead(node: HTMLElement): void; // of a list
}

export function scanList(world: ScanListWorld): ScanList {
  const finder = scanFinder(() => refresh());
  const content = element('div', { class: 'content' });
  const menus = new Map<string, Menu>(); // of the rows, by scan
  const images = thumbnailViews(thumbnails, world.token);
  let [scans, more, access]: [readonly ScanSummary[], boolean, Access] = [[], false, noAccess];
  let shown = '';

  // Only what differs is made and written, so that focus and selection stay where they are.
  const write = (key: string, made: () => Node[]): void => {
    if (key === shown) return;
    shown = key;
    images.clear();
    const focus = content.contains(document.activeElement)
      ? focusOf(document.activeElement!)
      : null;
    content.replaceChildren(...made());
    if (focus) content.querySelector<HTMLElement>(focus)?.focus();
  };
  const menuOf = (scan: ScanSummary): Menu => {
    menus.get(scan.id)?.dispose();
    const made = menu(t.actionsFor(scan.title), () => actionsOf(scan, access, world));
    menus.set(scan.id, made);
    return made;
  };
  // A menu that somebody has opened must not go away under their hand.
  const refresh = (): void => {
    if ([...menus.values()].some((one) => one.isOpen())) return;
    const there = scans.filter((scan) => !trash.has(scan.id));
    const now = serverClock.now(Date.now());
    const chosen = finder.find(there);
    const key = JSON.stringify([
      more,
      access,
      chosen,
      chosen.map((scan) => scan.started && ago(scan.started, now)),
    ]);
    if (there.length === 0) write('empty', () => [emptyList(access)]);
    else if (chosen.length === 0)
      write(`none ${finder.text()}`, () => [
        element('p', { class: 'notice' }, t.noTitleHasInIt(finder.text())),
      ]);
    else
      write(key, () => [
        listOf(chosen, now, images.make, access.scan ? menuOf : null),
        ...(more ? [olderButton(world.older)] : []),
      ]);
  };
  const unwatchTrash = onTrashChange(refresh);
  return {
    element: element('div', {}, ...finder.elements, content),
    show(...now) {
      [scans, more, access] = now;
      refresh();
    },
    showInstead(node) {
      finder.hide();
      shown = '';
      write('instead', () => [node]);
    },
    dispose() {
      unwatchTrash();
      images.clear();
      for (const one of menus.values()) one.dispose();
    },
  };
}

// Where the focus is, for the same row written anew.
function focusOf(node: Element): string | null {
  for (const name of ['href', 'aria-label'])
    if (node.hasAttribute(name)) return `[${name}="${CSS.escape(node.getAttribute(name)!)}"]`;
  return null;
}

function actionsOf(scan: ScanSummary, access: Access, world: ScanListWorld): MenuItem[] {
  const refused = (error: unknown): void => world.say(errorText(error));
  const stop = (): void =>
    void stopScan(scan.id, world.token()).then(() => world.changed(), refused);
  return [
    ...(access.scan
      ? [
          {
            label: t.rename,
            do: () => rename(scan.id, scan.title, world.token(), () => world.changed()),
          },
        ]
      : []),
    ...(access.scan
      ? [
          {
            label: t.tags,
            do: () => changeTags(scan.id, scan.tags, world.token(), () => world.changed()),
          },
        ]
      : []),
    ...(access.scan && scan.phase === 'running' ? [{ label: t.stopAndKeep, do: stop }] : []),
    ...(access.admin && scan.phase !== 'running'
      ? [{ label: t.delete, bad: true, do: () => deleteSoon(scan.id, scan.title, world.token()) }]
      : []),
  ];
}

function olderButton(showOlder: () => Promise<void>): HTMLElement {
  const button = buttonOf(t.olderScans, { class: 'button older' });
  button.addEventListener('click', () => {
    button.disabled = true;
    void showOlder();
  });
  return button;
}

type ImageOf = (scan: ScanSummary) => HTMLElement;

function listOf(
  scans: readonly ScanSummary[],
  now: Date,
  imageOf: ImageOf,
  menuOf: ((scan: ScanSummary) => Menu) | null,
): HTMLElement {
  const rows = scans.map((scan) =>
    element(
      'li',
      { class: 'scan-item' },
      rowOf(scan, now, imageOf(scan)),
      menuOf ? menuOf(scan).element : null,
    ),
  );
  return element('ul', { class: 'scans' }, ...rows);
}

function rowOf(scan: ScanSummary, now: Date, image: HTMLElement): HTMLElement {
  const mark = statusMark();
  mark.show(phaseText(scan.phase));
  const facts = [
    scan.imported ? t.imported : framesText(scan),
    scan.started && ago(scan.started, now),
  ];
  return element(
    'a',
    { class: 'scan-row', href: hashOf(scan.id) },
    image,
    element('span', { class: 'scan-title' }, scan.title),
    mark.element,
    element('span', { class: 'facts' }, facts.filter((fact) => fact !== null).join('  ·  ')),
    scan.words ? element('span', { class: 'facts words' }, scan.words) : null,
    scan.tags.length > 0 ? element('span', { class: 'tags' }, ...tagMarks(scan.tags)) : null,
  );
}

function emptyList(access: Access): HTMLElement {
  const command = `hermite-client stream synthetic --server '${location.origin}/#token=…'`;
  return element(
    'div',
    { class: 'empty-list' },
    element('p', { class: 'lead' }, t.noScansYet),
    access.scan ? element('p', {}, t.dropARecordingHereOrStream) : null,
    access.scan ? element('pre', {}, element('code', {}, command)) : null,
  );
}
