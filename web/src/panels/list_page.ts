// All scans of the server, newest first. The newest are asked for again every few seconds while the page is seen, older ones when somebody wants them.
import { ApiError, fetchScans, withOlder, type ScanSummary } from '../connection/api';
import { hashOf } from '../state/route';
import { ago, count, phaseWords } from '../state/words';
import { element, type Panel } from './dom';
import { jobsPanel } from './jobs_panel';
import { statusMark } from './mark';

const refresh_ms = 3_000;

export interface ListAccess {
  token(): string;
  setToken(token: string): void;
}

export interface ListPage extends Panel {
  scans(): readonly ScanSummary[];
}

export function listPage(access: ListAccess): ListPage {
  const content = element('div', { class: 'content' });
  const notice = element('p', { class: 'notice', role: 'status' });
  const jobs = jobsPanel(access.token, () => void refresh());
  const node = element('main', { class: 'list-page' }, wordmark(), element('h1', {}, 'Scans'), notice, jobs.element, content);
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
  const refresh = async (): Promise<void> => {
    clearTimeout(timer);
    try {
      if (document.visibilityState === 'visible') {
        const newest = await fetchScans(access.token());
        await jobs.refresh();
        if (disposed) return;
        if (!olderShown) more = newest.more;
        scans = olderShown ? withOlder(newest.scans, scans) : newest.scans;
        say('');
        jobs.element.hidden = false;
        const now = new Date();
        if (scans.length === 0) show('empty', emptyList());
        else show(JSON.stringify([more, scans, scans.map((scan) => scan.started && ago(scan.started, now))]), listOf(scans, now), ...(more ? [olderButton(showOlder)] : []));
      }
    } catch (error) {
      if (disposed) return;
      if (error instanceof ApiError && error.unauthorized) {
        say('');
        jobs.element.hidden = true;
        show('token', tokenForm(access, () => void refresh()));
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
      const next = await fetchScans(access.token(), last.id);
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

function listOf(scans: readonly ScanSummary[], now: Date): HTMLElement {
  return element('ul', { class: 'scans' }, ...scans.map((scan) => element('li', {}, rowOf(scan, now))));
}

function rowOf(scan: ScanSummary, now: Date): HTMLElement {
  const mark = statusMark();
  mark.show(phaseWords(scan.phase));
  const facts = [
    scan.imported ? 'Imported' : `${count(scan.frameCount)} ${scan.frameCount === 1 ? 'frame' : 'frames'}`,
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

function emptyList(): HTMLElement {
  const command = `hermite-client stream synthetic --server ${location.origin} --token …`;
  return element(
    'div',
    { class: 'empty-list' },
    element('p', { class: 'lead' }, 'No scans yet.'),
    element('p', {}, 'Drop a recording here, or stream one, or the synthetic room, and it appears here while it grows:'),
    element('pre', {}, element('code', {}, command)),
  );
}

function tokenForm(access: ListAccess, retry: () => void): HTMLElement {
  const input = element('input', { type: 'password', id: 'token', autocomplete: 'off', spellcheck: 'false', required: true });
  const form = element(
    'form',
    { class: 'token-form' },
    element('p', { class: 'lead' }, access.token() ? 'The server does not accept this access token.' : 'This server asks for an access token.'),
    element('p', {}, 'It printed a link with the token when it started. Open that link, or paste the token here.'),
    element('label', { for: 'token' }, 'Access token'),
    element('div', { class: 'field' }, input, element('button', { type: 'submit', class: 'button primary' }, 'Continue')),
  );
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    access.setToken(input.value);
    retry();
  });
  return form;
}
