// All scans of the server, newest first. The newest are asked for again every few seconds while the page is seen, older ones when somebody wants them.
import { ApiError, fetchScans, withOlder, type ScanSummary } from '../connection/api';
import { fetchAccess, noAccess, stopScan, type Access } from '../connection/scans';
import { hashOf } from '../state/route';
import { found, sorted, sortNames, type SortName } from '../state/scan_list';
import { ago, framesWords, phaseWords } from '../state/words';
import { element, type Panel } from './dom';
import { jobsPanel } from './jobs_panel';
import { statusMark } from './mark';
import { menu, type Menu, type MenuItem } from './menu';
import { deleteSoon, onTrashChange, rename, trash } from './scan_actions';

const refresh_ms = 3_000;
const searchedFrom = 2; // scans; one is found without
const sortLabels: Record<SortName, string> = { newest: 'Newest first', oldest: 'Oldest first', title: 'By title', frames: 'Most frames' };

export interface ListAccess {
  token(): string;
  setToken(token: string): void;
}

export interface ListPage extends Panel {
  scans(): readonly ScanSummary[];
}

export function listPage(door: ListAccess): ListPage {
  const content = element('div', { class: 'content' });
  const notice = element('p', { class: 'notice', role: 'status' });
  const jobs = jobsPanel(door.token, () => void refresh());
  const search = element('input', { type: 'search', placeholder: 'Search', 'aria-label': 'Search the titles of scans', autocomplete: 'off' });
  const order = element('select', { 'aria-label': 'Order of the scans' }, ...sortNames.map((name) => element('option', { value: name }, sortLabels[name])));
  const finder = element('div', { class: 'finder' }, search, order);
  const node = element('main', { class: 'list-page' }, wordmark(), element('h1', {}, 'Scans'), notice, jobs.element, finder, content, jobs.failed);
  let access: Access = noAccess;
  const menus = new Map<string, Menu>(); // of the rows, by scan
  let scans: readonly ScanSummary[] = [];
  let olderShown = false; // some beyond what the server tells at once
  let more = false;
  let shown = '';
  let timer: ReturnType<typeof setTimeout> | undefined;
  let disposed = false;

  // Only what differs is written, so that focus and selection stay where they are.
  const show = (key: string, ...children: Node[]): void => {
    if (key === shown) return;
    shown = key;
    const focused = content.contains(document.activeElement) ? document.activeElement?.getAttribute('href') : null;
    content.replaceChildren(...children);
    if (focused) content.querySelector<HTMLElement>(`[href="${CSS.escape(focused)}"]`)?.focus();
  };
  const say = (words: string): void => {
    notice.hidden = words === '';
    if (notice.textContent !== words) notice.textContent = words;
  };
  const sayError = (error: unknown): void => say(error instanceof ApiError ? error.message : 'That did not work.');
  const actionsOf = (scan: ScanSummary): MenuItem[] => [
    ...(access.scan ? [{ label: 'Rename', do: () => rename(scan.id, scan.title, door.token(), () => void refresh()) }] : []),
    ...(access.scan && scan.phase === 'running' ? [{ label: 'Stop and keep', do: () => void stopScan(scan.id, door.token()).then(refresh, sayError) }] : []),
    ...(access.admin && scan.phase !== 'running' ? [{ label: 'Delete', bad: true, do: () => deleteSoon(scan.id, scan.title, door.token()) }] : []),
  ];
  const menuOf = (scan: ScanSummary): Menu => {
    menus.get(scan.id)?.dispose();
    const made = menu(`Actions for ${scan.title}`, () => actionsOf(scan));
    menus.set(scan.id, made);
    return made;
  };
  // A menu that somebody has opened must not go away under their hand.
  const showScans = (): void => {
    if ([...menus.values()].some((one) => one.isOpen())) return;
    const there = scans.filter((scan) => !trash.has(scan.id));
    const now = new Date();
    finder.hidden = there.length < searchedFrom;
    const chosen = finder.hidden ? there : sorted(found(there, search.value), order.value as SortName);
    const key = JSON.stringify([more, access, chosen, chosen.map((scan) => scan.started && ago(scan.started, now))]);
    if (there.length === 0) show('empty', emptyList(access));
    else if (chosen.length === 0) show(`none ${search.value}`, element('p', { class: 'notice' }, `No title has “${search.value}” in it.`));
    else show(key, listOf(chosen, now, access.scan ? menuOf : null), ...(more ? [olderButton(showOlder)] : []));
  };
  for (const [field, event] of [[search, 'input'], [order, 'change']] as const) field.addEventListener(event, showScans);
  const unwatchTrash = onTrashChange(() => showScans());
  finder.hidden = true;
  const refresh = async (): Promise<void> => {
    clearTimeout(timer);
    try {
      if (document.visibilityState === 'visible') {
        const newest = await fetchScans(door.token());
        access = await fetchAccess(door.token());
        jobs.allow(access.scan);
        await jobs.refresh();
        if (disposed) return;
        if (!olderShown) more = newest.more;
        scans = olderShown ? withOlder(newest.scans, scans) : newest.scans;
        say('');
        showScans();
      }
    } catch (error) {
      if (disposed) return;
      if (error instanceof ApiError && error.unauthorized) {
        say('');
        jobs.allow(false);
        finder.hidden = true;
        show('token', tokenForm(door, () => void refresh()));
        return; // until a token is given
      }
      say(error instanceof ApiError ? error.message : 'The list of scans could not be loaded.');
    }
    timer = setTimeout(() => void refresh(), refresh_ms);
  };
  const showOlder = async (): Promise<void> => {
    const last = scans.at(-1);
    if (!last) return;
    try {
      const next = await fetchScans(door.token(), last.id);
      scans = withOlder(scans, next.scans);
      olderShown = true;
      more = next.more;
    } catch (error) {
      say(error instanceof ApiError ? error.message : 'Older scans could not be loaded.');
    }
    if (!disposed) await refresh();
  };
  say('Loading.');
  void refresh();
  const onVisible = (): void => void refresh();
  document.addEventListener('visibilitychange', onVisible);
  document.title = 'Hermite';
  return {
    element: node,
    scans: () => scans,
    dispose() {
      disposed = true;
      clearTimeout(timer);
      jobs.dispose();
      unwatchTrash();
      for (const one of menus.values()) one.dispose();
      document.removeEventListener('visibilitychange', onVisible);
    },
  };
}

function wordmark(): HTMLElement {
  return element('p', { class: 'wordmark' }, element('img', { src: './icon.svg', alt: '', width: 28, height: 28 }), 'Hermite');
}

function olderButton(showOlder: () => Promise<void>): HTMLElement {
  const button = element('button', { type: 'button', class: 'button older' }, 'Older scans');
  button.addEventListener('click', () => {
    button.disabled = true;
    void showOlder();
  });
  return button;
}

function listOf(scans: readonly ScanSummary[], now: Date, menuOf: ((scan: ScanSummary) => Menu) | null): HTMLElement {
  const rows = scans.map((scan) => element('li', { class: 'scan-item' }, rowOf(scan, now), menuOf ? menuOf(scan).element : null));
  return element('ul', { class: 'scans' }, ...rows);
}

function rowOf(scan: ScanSummary, now: Date): HTMLElement {
  const mark = statusMark();
  mark.show(phaseWords(scan.phase));
  const facts = [
    scan.imported ? 'Imported' : framesWords(scan),
    scan.started && ago(scan.started, now),
  ];
  return element(
    'a',
    { class: 'scan-row', href: hashOf(scan.id) },
    element('span', { class: 'scan-title' }, scan.title),
    mark.element,
    element('span', { class: 'facts' }, facts.filter((fact) => fact !== null).join('  ·  ')),
    scan.words ? element('span', { class: 'facts words' }, scan.words) : null,
  );
}

function emptyList(access: Access): HTMLElement {
  const command = `hermite-client stream synthetic --server '${location.origin}/#token=…'`;
  return element(
    'div',
    { class: 'empty-list' },
    element('p', { class: 'lead' }, 'No scans yet.'),
    access.scan ? element('p', {}, 'Drop a recording here, or stream one, or the synthetic room, and it appears here while it grows:') : null,
    access.scan ? element('pre', {}, element('code', {}, command)) : null,
  );
}

function tokenForm(door: ListAccess, retry: () => void): HTMLElement {
  const input = element('input', { type: 'password', id: 'token', autocomplete: 'off', spellcheck: 'false', required: true });
  const form = element(
    'form',
    { class: 'token-form' },
    element('p', { class: 'lead' }, door.token() ? 'The server does not accept this access token.' : 'This server asks for an access token.'),
    element('p', {}, 'It printed a link with the token when it started. Open that link, or paste the token here.'),
    element('label', { for: 'token' }, 'Access token'),
    element('div', { class: 'field' }, input, element('button', { type: 'submit', class: 'button primary' }, 'Continue')),
  );
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    door.setToken(input.value);
    retry();
  });
  return form;
}
