// What a person does with a scan, wherever it stands: another title, tags, away with it. What was
// deleted can be taken back for a few seconds.
import { ApiError, type ScanSummary } from '../connection/api';
import { deleteScan, labelScan } from '../connection/scans';
import { Trash } from '../state/trash';
import { t } from '../texts/texts';
import { askForTags, askForTitle } from './dialogs';
import { buttonOf, element, setText } from './dom';

const problemFor_ms = 8_000;

const message = element('span');
const undo = buttonOf(t.undo);
const toast = element('div', { class: 'card toast', role: 'status' }, message, undo);
toast.hidden = true;
let problemUntil: ReturnType<typeof setTimeout> | undefined;
let tokenNow = '';
let changedNow = (): void => {};

export const trash = new Trash(
  {
    delete: (id, leaving) => deleteScan(id, tokenNow, leaving),
    after: (delay_ms, action) => {
      const timer = setTimeout(action, delay_ms);
      return () => clearTimeout(timer);
    },
  },
  () => {
    show();
    changedNow();
  },
  (one, error) => {
    say(t.couldNotBeDeleted(one.title, error instanceof ApiError ? error.message : ''));
  },
);
undo.addEventListener('click', () => trash.newest && trash.undo(trash.newest.id));
addEventListener('pagehide', () => trash.emptyAll());

// `changed` is called whenever a scan has come or gone.
export function onTrashChange(changed: () => void): () => void {
  changedNow = changed;
  return () => {
    if (changedNow === changed) changedNow = () => {};
  };
}

export function deleteSoon(id: string, title: string, token: string): void {
  tokenNow = token;
  trash.put({ id, title });
}

export function rename(
  id: string,
  title: string,
  token: string,
  renamed: (title: string) => void,
): void {
  askForTitle(title, async (wanted) => {
    if (wanted !== title) await labelScan(id, { title: wanted }, token);
    renamed(wanted);
  });
}

export function changeTags(
  id: string,
  tags: readonly string[],
  token: string,
  changed: (scan: ScanSummary) => void,
): void {
  askForTags(tags, async (wanted) => {
    changed(await labelScan(id, { tags: wanted }, token));
  });
}

function show(): void {
  clearTimeout(problemUntil);
  if (!toast.isConnected) document.body.append(toast);
  const { newest } = trash;
  toast.hidden = newest === null;
  undo.hidden = false;
  if (newest) setText(message, t.isDeleted(newest.title));
}

function say(text: string): void {
  setText(message, text);
  undo.hidden = true;
  toast.hidden = false;
  problemUntil = setTimeout(() => show(), problemFor_ms);
}
