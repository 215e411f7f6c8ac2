// Choosing the scan that another one is compared with.
import { errorText, fetchScans, type ScanSummary } from '../connection/api';
import { ordered } from '../state/comparing';
import { compareHash } from '../state/route';
import { locale, t } from '../texts/texts';
import { openDialog } from './dialogs';
import { buttonOf, element, setText } from './dom';

// Goes to the page of the comparison when somebody has chosen.
export function chooseCompared(scanId: string, token: string): void {
  const search = element('input', {
    type: 'search',
    'aria-label': t.searchTheTitlesOfScans,
    placeholder: t.search,
    autocomplete: 'off',
  });
  const list = element('ul', { class: 'compare-choices' });
  const notice = element('p', { class: 'notice', role: 'status' }, t.loadingNow);
  const cancel = buttonOf(t.cancel);
  const close = openDialog(
    t.compareWith,
    element('div', {}, search, notice, list, element('div', { class: 'dialog-buttons' }, cancel)),
  );
  cancel.addEventListener('click', close);
  let scans: readonly ScanSummary[] = [];
  const rowOf = (scan: ScanSummary, own: ScanSummary): HTMLElement => {
    const button = element(
      'button',
      { type: 'button', class: 'menu-row compare-choice' },
      element('span', { class: 'scan-title' }, scan.title),
      element(
        'span',
        { class: 'facts' },
        scan.started?.toLocaleString(locale, { dateStyle: 'medium', timeStyle: 'short' }) ?? '',
      ),
    );
    button.addEventListener('click', () => {
      close();
      const [first, second] = ordered(own, scan);
      location.hash = compareHash(first.id, second.id);
    });
    return element('li', {}, button);
  };
  const show = (): void => {
    const own = scans.find(({ id }) => id === scanId);
    const wanted = search.value.trim().toLowerCase();
    const others = scans.filter(
      (scan) => scan.id !== scanId && (scan.phase === 'finished' || scan.phase === 'interrupted'),
    );
    const found = others.filter(({ title }) => title.toLowerCase().includes(wanted));
    setText(
      notice,
      others.length === 0
        ? t.thereIsNoOtherScanThat
        : found.length === 0
          ? t.noTitleHasInIt(search.value.trim())
          : '',
    );
    notice.hidden = found.length > 0;
    list.replaceChildren(...(own ? found.map((scan) => rowOf(scan, own)) : []));
  };
  search.addEventListener('input', show);
  fetchScans(token).then(
    (answer) => {
      scans = answer.scans;
      show();
    },
    (error: unknown) => setText(notice, errorText(error, t.theListOfScansCouldNot)),
  );
}
