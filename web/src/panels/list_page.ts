// All scans of the server, newest first. The newest are asked for again every few seconds while the
// page is seen, older ones when somebody wants them.
import { ApiError, fetchScans, type ScanSummary } from '../connection/api';
import { fetchAccess } from '../connection/scans';
import { KnownScans } from '../state/known_scans';
import { t } from '../texts/texts';
import { element, type Panel } from './dom';
import { jobsPanel } from './jobs_panel';
import { languageChoice } from './language_choice';
import { noticeLine } from './notice';
import { scanList } from './scan_list';
import { whileSeen } from './while_seen';

const refresh_ms = 3_000;

export interface ListAccess {
  token(): string;
  setToken(token: string): void;
}

export interface ListPage extends Panel {
  scans(): readonly ScanSummary[];
}

export function listPage(door: ListAccess): ListPage {
  const { element: notice, say } = noticeLine();
  const jobs = jobsPanel(door.token, () => void refreshing.again());
  const list = scanList({
    token: door.token,
    changed: () => void refreshing.again(),
    older: () => showOlder(),
    say,
  });
  const parts = [
    wordmark(),
    element('h1', {}, t.scans),
    notice,
    jobs.element,
    list.element,
    jobs.failed,
  ];
  const known = new KnownScans();
  let disposed = false;

  const load = async (): Promise<void> => {
    const newest = await fetchScans(door.token());
    const access = await fetchAccess(door.token());
    if (disposed) return;
    jobs.allow(access.scan);
    await jobs.refresh();
    if (disposed) return;
    known.takeNewest(newest);
    say('');
    list.show(known.all, known.more, access);
  };
  const refreshing = whileSeen(refresh_ms, async () => {
    try {
      await load();
    } catch (error) {
      if (disposed) return false;
      if (error instanceof ApiError && error.unauthorized) {
        say('');
        jobs.allow(false);
        list.showInstead(tokenForm(door, () => void refreshing.again()));
        return false; // until a token is given
      }
      say(error instanceof ApiError ? error.message : t.theListOfScansCouldNot);
    }
    return true;
  });
  const showOlder = async (): Promise<void> => {
    const last = known.all.at(-1);
    if (!last) return;
    try {
      known.takeOlder(await fetchScans(door.token(), last.id));
    } catch (error) {
      say(error instanceof ApiError ? error.message : t.olderScansCouldNotBeLoaded);
    }
    if (!disposed) await refreshing.again();
  };
  say(t.loadingNow);
  void refreshing.again();
  document.title = 'Hermite';
  return {
    element: element('main', { class: 'list-page' }, ...parts),
    scans: () => known.all,
    dispose() {
      disposed = true;
      refreshing.dispose();
      jobs.dispose();
      list.dispose();
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
  const input = element('input', {
    type: 'password',
    id: 'token',
    autocomplete: 'off',
    spellcheck: 'false',
    required: true,
  });
  const form = element(
    'form',
    { class: 'token-form' },
    element(
      'p',
      { class: 'lead' },
      door.token() ? t.theServerDoesNotAcceptThis : t.thisServerAsksForAnAccess,
    ),
    element('p', {}, t.itPrintedALinkWithThe),
    element('label', { for: 'token' }, t.accessToken),
    element(
      'div',
      { class: 'field' },
      input,
      element('button', { type: 'submit', class: 'button primary' }, t.continue),
    ),
  );
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    door.setToken(input.value);
    retry();
  });
  return form;
}
