// What somebody writes and has not saved, kept in this tab by scan: it is there again after a
// reload, and when one comes back to the scan.
import { isRecord, textOf } from '../connection/api';
import { placeOf } from '../connection/measurements';
import { parseNote, viewOf } from '../connection/notes';
import { isUnsaved, type Draft } from './noting';

const storedAs = 'hermite.notes';
const kept_count = 20; // scans, those that were written in last
const most_chars = 10_000; // of a text; the server takes a fifth of it

type Reading = Pick<Storage, 'getItem'>;
type Row = readonly [string, unknown];

// Null: there is none, or none that can be read.
export function storedDraft(storage: Reading, scanId: string): Draft | null {
  return draftOf(rowsOf(storage).find(([id]) => id === scanId)?.[1]);
}

// A draft without text of its own is not kept.
export function storeDraft(
  storage: Reading & Pick<Storage, 'setItem'>,
  scanId: string,
  draft: Draft | null,
): void {
  const rows = rowsOf(storage);
  const others = rows.filter(([id]) => id !== scanId);
  const unsaved = draft && isUnsaved(draft) ? draft : null;
  if (!unsaved && others.length === rows.length) return;
  const all: Row[] = unsaved
    ? [...others, [scanId, { ...unsaved, text: unsaved.text.slice(0, most_chars), theirs: null }]]
    : others;
  try {
    storage.setItem(storedAs, JSON.stringify(all.slice(-kept_count)));
  } catch {
    // A browser that keeps nothing.
  }
}

function rowsOf(storage: Reading): Row[] {
  try {
    const json: unknown = JSON.parse(storage.getItem(storedAs) ?? '[]');
    return Array.isArray(json)
      ? json.filter((row): row is Row => Array.isArray(row) && typeof row[0] === 'string')
      : [];
  } catch {
    return [];
  }
}

// What others have made of the note meanwhile is found out when it is saved.
function draftOf(json: unknown): Draft | null {
  if (!isRecord(json)) return null;
  const [position_m, text] = [placeOf(json['position_m']), textOf(json['text'])];
  if (!position_m) return null;
  try {
    const of = json['of'] === null ? null : parseNote(json['of']);
    const draft = { of, position_m, view: viewOf(json['view']), text, theirs: null };
    return isUnsaved(draft) ? draft : null;
  } catch {
    return null;
  }
}
