import { afterEach, expect, test, vi } from 'vitest';
import { changeNote, conflictIn, createNote, parseNote, parseNotes, removeNote } from './notes';

const row = {
  id: 'a',
  position_m: [1, 2, 3],
  view: { position_m: [0, 0, 0], target_m: [0, 0, 1] },
  text: 'a crack',
  version: 2,
  created_at: '2024-05-01T12:00:00.123Z',
  changed_at: '2024-05-01T12:00:01.123Z',
};
const note = parseNote(row);

afterEach(() => vi.unstubAllGlobals());

// What the server is asked, and what it answers.
function answering(status: number, body: unknown): { path: string; init: RequestInit }[] {
  const asked: { path: string; init: RequestInit }[] = [];
  vi.stubGlobal('fetch', (path: string, init: RequestInit) => {
    asked.push({ path, init });
    return Promise.resolve(new Response(JSON.stringify(body), { status }));
  });
  return asked;
}

test('a note is read with its view, and without one', () => {
  expect(note).toMatchObject({
    id: 'a',
    position_m: [1, 2, 3],
    text: 'a crack',
    version: 2,
    view: { target_m: [0, 0, 1] },
  });
  expect(note.changed?.getTime()).toBe(Date.parse(row.changed_at));
  expect(parseNote({ ...row, view: null, changed_at: 'once' })).toMatchObject({
    view: null,
    changed: null,
  });
});

test('rows that are no notes are left out', () => {
  const wrong = [
    { ...row, id: 7 },
    { ...row, text: '' },
    { ...row, version: '2' },
    { ...row, position_m: [1, 2] },
    null,
  ];
  expect(parseNotes({ notes: [...wrong, row] })).toHaveLength(1);
  expect(() => parseNotes({})).toThrow('cannot be read');
});

test('a new note is sent without a view if there is none', async () => {
  const asked = answering(201, row);
  await createNote('s', 't', { position_m: [1, 2, 3], view: null, text: 'a crack' });
  expect(JSON.parse(asked[0]!.init.body as string)).toEqual({
    position_m: [1, 2, 3],
    text: 'a crack',
  });
});

test('a change names its version, and a conflict comes with the note as it is now', async () => {
  const asked = answering(200, { ...row, version: 3 });
  expect(await changeNote('s', 't', note, 'repaired')).toMatchObject({
    kind: 'done',
    note: { version: 3 },
  });
  expect(asked[0]!.path).toBe('api/v1/scans/s/notes/a');
  expect(JSON.parse(asked[0]!.init.body as string)).toEqual({ text: 'repaired', version: 2 });
  answering(409, {
    error: { code: 'busy', message: 'changed' },
    note: { ...row, text: 'theirs', version: 3 },
  });
  expect(await changeNote('s', 't', note, 'repaired')).toMatchObject({
    kind: 'conflict',
    now: { text: 'theirs', version: 3 },
  });
  answering(404, { error: { code: 'not_found', message: 'no note' } });
  expect(await changeNote('s', 't', note, 'repaired')).toEqual({ kind: 'gone' });
  answering(403, {});
  await expect(changeNote('s', 't', note, 'repaired')).rejects.toThrow('does not allow');
});

test('a removal names its version', async () => {
  const asked = answering(200, { removed: 'a' });
  expect(await removeNote('s', 't', note)).toMatchObject({ kind: 'done' });
  expect(asked[0]!.path).toBe('api/v1/scans/s/notes/a?version=2');
  answering(409, { error: { code: 'busy', message: 'something else' } });
  await expect(removeNote('s', 't', note)).rejects.toThrow('something else');
});

test('another refusal is no conflict', () => {
  expect(conflictIn('<html>')).toBeNull();
  expect(conflictIn('{"error": {}}')).toBeNull();
});
