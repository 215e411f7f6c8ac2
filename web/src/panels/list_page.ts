// All scans of the server, newest first. The newest are asked for again every few seconds while the page is seen, older ones when somebody wants them.
import { ApiError, fetchScans, withOlder, type ScanSummary } from '../connection/api';
import { fetchAccess } from '../connection/scans';
import { t } from '../texts/texts';
import { element, type Panel } from './dom';
import { jobsPanel } from './jobs_panel';
import { languageChoice } from './language_choice';
import { scanList } from './scan_list';

const refresh_ms = 3_000;

export interface ListAccess {
  token(): string;
  setToken(token: string): void;
}

export interface ListPage extends Panel {
  scans(): readonly ScanSummary[];
}

export function listPage(door: ListAccess): ListPage {
  const notice = element('p', { class: 'notice', role: 'status' });
  const say = (text: string): void => {
    notice.hidden = text === '';
    if (notice.textContent !== text) notice.textContent = text;
  };
  const jobs = jobsPanel(door.token, () => void refresh());
  const list = scanList({ token: door.token, changed: () => void refresh(), older: () => showOlder(), say });
  const node = element(
    'main',
    { class: 'list-page' },
    wordmark(),
    element('h1', {}, t.scans),
    notice,
    jobs.element,
    list.element,
    jobs.failed,
  );
  let scans: readonly ScanSummary[] = [];
  let olderShown = false; // some beyond what the server tells at once
  let more = false;
  let timer: ReturnType<typeof setTimeout> | undefined;
  let disposed = false;

  const load = async (): Promise<void> => {
    const newest = await fetchScans(door.token());
    const access = await fetchAccess(door.token());
    if (disposed) return;
    jobs.allow(access.scan);
    await jobs.refresh();
    if (disposed) return;
    if (!olderShown) more = newest.more;
    scans = olderShown ? withOlder(newest.scans, scans) : newest.scans;
    say('');
    list.show(scans, more, access);
  };
  const refresh = async (): Promise<void> => {
    clearTimeout(timer);
    try {
      if (document.visibilityState === 'visible') await load();
    } catch (error) {
      if (disposed) return;
      if (error instanceof ApiError && error.unauthorized) {
        say('');
        jobs.allow(false);
        list.showInstead(tokenForm(door, () => void refresh()));
        return; // until a token is given
      }
      say(error instanceof ApiError ? error.message : t.theListOfScansCouldNot);
    }
    if (!disposed) timer = setTimeout(() => void refresh(), refresh_ms);
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
      say(error instanceof ApiError ? error.message : t.olderScansCouldNotBeLoaded);
    }
    if (!disposed) await refresh();
  };
  say(t.loadingNow);
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
      list.dispose();
      document.removeEventListener('visibilitychange', onVisible);
    },
  };
}

function wordmark(): HTMLElement {
  return element(
    'div',
    { class: 'wordmark' },
    element('img', { src: './icon.svg', alt: '', width: 28, height: 28 }),
    'Hermite',
    languageChoice(),
  );
}

function tokenForm(door: ListAccess, retry: () => void): HTMLElement {
  const input = element('input', { type: 'password', id: 'token', autocomplete: 'off', spellcheck: 'false', required: true });
  const form = element(
    'form',
    { class: 'token-form' },
    element('p', { class: 'lead' }, door.token() ? t.theServerDoesNotAcceptThis : t.thisServerAsksForAnAccess),
    element('p', {}, t.itPrintedALinkWithThe),
    element('label', { for: 'token' }, t.accessToken),
    element('div', { class: 'field' }, input, element('button', { type: 'submit', class: 'button primary' }, t.continue)),
  );
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    door.setToken(input.value);
    retry();
  });
  return form;
}
