// What people have written at places of a scan that has ended. A change names the version that it
// was made of: nobody's text is lost.
import { t } from '../texts/texts';
import { ApiError, isRecord, numberOf, refusalOf, request, scanPath, textOf } from './api';
import { placeOf, type Place } from './measurements';

const limit_ms = 15_000;

// In the world of the scan, metres.
export interface NoteView {
  readonly position_m: Place; // of the eye
  readonly target_m: Place; // what is in the middle of the image
}

export interface Note {
  readonly id: string;
  readonly position_m: Place; // on the surface, in the world of the scan
  readonly view: NoteView | null; // from which it was written
  readonly text: string;
  readonly version: number; // grows with each change
  readonly changed: Date | null;
}

export interface NewNote {
  readonly position_m: Place;
  readonly view: NoteView | null;
  readonly text: string;
}

// What came of changing or removing a version of a note.
export type NoteChange =
  | { readonly kind: 'done'; readonly note: Note }
  | { readonly kind: 'conflict'; readonly now: Note } // it has another version by now
  | { readonly kind: 'gone' }; // somebody has removed it

const headers = { 'Content-Type': 'application/json' };
const unreadable = (): ApiError => new ApiError(t.theServersAnswerCannotBeRead, false);
const pathOf = (scanId: string, id: string): string =>
  `${scanPath(scanId)}/notes/${encodeURIComponent(id)}`;

// Oldest first.
export async function fetchNotes(scanId: string, token: string): Promise<Note[]> {
  const response = await request(`${scanPath(scanId)}/notes`, token, { limit_ms });
  return parseNotes(await response.json());
}

export async function createNote(
  scanId: string,
  token: string,
  { position_m, view, text }: NewNote,
): Promise<Note> {
  const body = JSON.stringify({ position_m, text, ...(view ? { view } : {}) });
  const response = await request(`${scanPath(scanId)}/notes`, token, {
    limit_ms,
    method: 'POST',
    headers,
    body,
  });
  return parseNote(await response.json());
}

// `note`: as it was read.
export async function changeNote(
  scanId: string,
  token: string,
  note: Note,
  text: string,
): Promise<NoteChange> {
  const body = JSON.stringify({ text, version: note.version });
  const response = await request(pathOf(scanId, note.id), token, {
    limit_ms,
    method: 'PATCH',
    headers,
    body,
    expected: [404, 409],
  });
  return response.ok ? { kind: 'done', note: parseNote(await response.json()) } : notDone(response);
}

// `leaving`: the page goes, and the request must not go with it.
export async function removeNote(
  scanId: string,
  token: string,
  note: Note,
  leaving = false,
): Promise<NoteChange> {
  const path = `${pathOf(scanId, note.id)}?version=${note.version}`;
  const response = await request(path, token, {
    limit_ms,
    method: 'DELETE',
    keepalive: leaving,
    expected: [404, 409],
  });
  return response.ok ? { kind: 'done', note } : notDone(response);
}

async function notDone(response: Response): Promise<NoteChange> {
  if (response.status === 404) return { kind: 'gone' };
  const body = await response.text();
  const now = conflictIn(body);
  if (!now) throw new ApiError(refusalOf(body, response.status), false, true);
  return { kind: 'conflict', now };
}

// The note that a refusal has beside its error; null: it is another refusal.
export function conflictIn(body: string): Note | null {
  try {
    const json: unknown = JSON.parse(body);
    return isRecord(json) ? parseNote(json['note']) : null;
  } catch {
    return null;
  }
}

// Rows that are none are left out.
export function parseNotes(json: unknown): Note[] {
  const rows = isRecord(json) && Array.isArray(json['notes']) ? json['notes'] : null;
  if (!rows) throw unreadable();
  return rows.flatMap((row) => {
    try {
      return [parseNote(row)];
    } catch {
      return [];
    }
  });
}

export function parseNote(json: unknown): Note {
  if (!isRecord(json)) throw unreadable();
  const [id, text] = [textOf(json['id']), textOf(json['text'])];
  const [version, position_m] = [numberOf(json['version']), placeOf(json['position_m'])];
  if (id === '' || text === '' || version === null || !position_m) throw unreadable();
  const changed_ms = Date.parse(textOf(json['changed_at']));
  const changed = Number.isNaN(changed_ms) ? null : new Date(changed_ms);
  return { id, position_m, view: viewOf(json['view']), text, version, changed };
}

// Null: it is none.
export function viewOf(json: unknown): NoteView | null {
  if (!isRecord(json)) return null;
  const [position_m, target_m] = [placeOf(json['position_m']), placeOf(json['target_m'])];
  return position_m && target_m ? { position_m, target_m } : null;
}
