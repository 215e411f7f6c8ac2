import { expect, test } from 'vitest';
import type { Note, NoteView } from '../connection/notes';
import {
  chosenNote,
  cleaned,
  heldText,
  initialNoting,
  isUnsaved,
  notingText,
  reduceNoting,
  shownNotes,
  textProblem,
} from './noting';
import type { Noting, NotingEvent } from './noting';

const view: NoteView = { position_m: [0, 0, -1], target_m: [0, 0, 1] };
const note = (id: string, text = `text of ${id}`, version = 1): Note => ({
  id,
  position_m: [1, 2, 3],
  view,
  text,
  version,
  changed: null,
});
const after = (...events: NotingEvent[]): Noting => events.reduce(reduceNoting, initialNoting);
const list = { kind: 'listed', notes: [note('a'), note('b')] } as const;
const open = [{ kind: 'access', mayWrite: true }, { kind: 'active', active: true }, list] as const;
const click = { kind: 'placed', position_m: [4, 5, 6], view } as const;
const typed = (text: string) => ({ kind: 'typed', text }) as const;
const saving = { kind: 'saving' } as const;
const editing = [
  ...open,
  { kind: 'chosen', id: 'a' },
  { kind: 'edited' },
  typed('mine'),
  saving,
] as const;
const conflict = { kind: 'conflict', now: note('a', 'theirs', 5) } as const;

test('a click puts a pin, another one moves it, and the saved note is chosen', () => {
  expect(after(...open, click).draft).toMatchObject({ of: null, position_m: [4, 5, 6], text: '' });
  const moved = after(...open, click, typed('a crack'), { ...click, position_m: [7, 8, 9] });
  expect(moved.draft).toMatchObject({ position_m: [7, 8, 9], text: 'a crack' });
  const state = [saving, { kind: 'saved', note: note('c') } as const].reduce<Noting>(
    reduceNoting,
    moved,
  );
  expect(state).toMatchObject({ draft: null, busy: false, chosen: 'c' });
  expect(state.notes.map(({ id }) => id)).toEqual(['a', 'b', 'c']);
});

test('a click beside everything says so; none counts while closed or if one may only look', () => {
  expect(notingText(after(...open, { ...click, position_m: null }))).toContain('nothing');
  expect(after(...open, { kind: 'access', mayWrite: false }, click).draft).toBeNull();
  expect(after(...open, { kind: 'active', active: false }, click).draft).toBeNull();
  expect(notingText(after({ kind: 'active', active: true }))).toBe('There are no notes.');
});

test('what is written survives a new list, a closed panel and a failed saving', () => {
  const again = [
    { kind: 'listed', notes: [note('b')] },
    { kind: 'active', active: false },
    { kind: 'active', active: true },
  ] as const;
  const state = after(...open, click, typed('a crack'), ...again);
  expect(state.draft?.text).toBe('a crack');
  const failed = [saving, { kind: 'failed', message: 'No.' } as const].reduce<Noting>(
    reduceNoting,
    state,
  );
  expect(failed).toMatchObject({ busy: false, problem: 'No.', draft: { text: 'a crack' } });
});

test('the same list again is the same state', () => {
  const state = after(...open);
  expect(reduceNoting(state, { kind: 'listed', notes: [note('a'), note('b')] })).toBe(state);
});

test('what goes wrong beside a saving does not end it, and a new list ends the problem', () => {
  const state = after(
    ...open,
    click,
    typed('a'),
    saving,
    { kind: 'unlisted', message: 'Not reached.' },
    { kind: 'refused', message: 'No.' },
  );
  expect(state).toMatchObject({ busy: true, problem: 'No.', unlisted: 'Not reached.' });
  const unlisted = after(...open, { kind: 'unlisted', message: 'Not reached.' });
  expect(notingText(unlisted)).toBe('Not reached.');
  expect(reduceNoting(unlisted, { kind: 'listed', notes: unlisted.notes }).unlisted).toBe('');
});

test('a chosen note that is not there any more is said to be so', () => {
  const state = after({ kind: 'chosen', id: 'c' }, ...open);
  expect(state.chosen).toBeNull();
  expect(notingText(state)).toContain('does not exist');
});

test('nothing empty and nothing too long is sent', () => {
  expect(after(...open, click, saving)).toMatchObject({
    busy: false,
    problem: 'A note has at least one letter.',
  });
  expect(textProblem('🧱'.repeat(500))).toBe('');
  expect(textProblem('🧱'.repeat(501))).toBe('This has 2004 bytes, allowed are 2000.');
  expect(after(...open, click, typed('a'), saving)).toMatchObject({ busy: true });
});

test('a text is sent as the server takes it', () => {
  expect(cleaned('  a\r\nb\tc\u0000\u0085\u001b\ud83e \n')).toBe('a\nb c');
  expect(cleaned('🧱')).toBe('🧱');
});

test('two texts of one note are both there until one has chosen', () => {
  const state = after(...editing, conflict);
  expect(state).toMatchObject({ busy: false, draft: { text: 'mine', theirs: { text: 'theirs' } } });
  expect(notingText(state)).toContain('Somebody has changed this note');
  expect(chosenNote(state)?.text).toBe('theirs');
  expect(reduceNoting(state, { kind: 'resolved', keep: 'theirs' }).draft).toBeNull();
  expect(reduceNoting(state, { kind: 'resolved', keep: 'mine' }).draft).toMatchObject({
    of: { version: 5 },
    text: 'mine',
    theirs: null,
  });
  const both = reduceNoting(state, { kind: 'resolved', keep: 'both' });
  expect(both.draft).toMatchObject({ of: { version: 5 }, text: 'theirs\n\nmine', theirs: null });
});

test('two texts that are too long for one note become two', () => {
  const long = 'm'.repeat(1996);
  const written = after(
    ...open,
    { kind: 'chosen', id: 'a' },
    { kind: 'edited' },
    typed(long),
    saving,
    conflict,
  );
  const state = reduceNoting(written, { kind: 'resolved', keep: 'both' });
  expect(state.draft).toMatchObject({ of: null, position_m: [1, 2, 3], text: long, theirs: null });
});

test('somebody else is faster again', () => {
  const again = { kind: 'conflict', now: note('a', 'theirs again', 6) } as const;
  const state = after(...editing, conflict, { kind: 'resolved', keep: 'mine' }, saving, again);
  expect(state.draft).toMatchObject({ text: 'mine', theirs: { text: 'theirs again', version: 6 } });
});

test('the text of a note that somebody has removed becomes a new note', () => {
  const state = after(...editing, { kind: 'gone' });
  expect(state.draft).toMatchObject({ of: null, position_m: [1, 2, 3], text: 'mine' });
  expect(state.notes.map(({ id }) => id)).toEqual(['b']);
  expect(notingText(state)).toContain('has removed this note');
});

test('a note that was removed a moment ago is not seen, and comes back', () => {
  const state = after(...open, { kind: 'chosen', id: 'a' }, { kind: 'away', ids: ['a'] });
  expect(shownNotes(state).map(({ id }) => id)).toEqual(['b']);
  expect(state.chosen).toBeNull();
  expect(shownNotes(reduceNoting(state, { kind: 'away', ids: [] }))).toHaveLength(2);
});

test('a click does not take a text away that is changed', () => {
  const state = after(
    ...open,
    { kind: 'chosen', id: 'a' },
    { kind: 'edited' },
    typed('mine'),
    click,
  );
  expect(state.draft).toMatchObject({ of: { id: 'a' }, text: 'mine' });
  expect(isUnsaved(state.draft)).toBe(true);
  expect(isUnsaved(after(...open, click).draft)).toBe(false);
});

test('what was saved without an answer is no draft any more once it is in the list', () => {
  const lost = [saving, { kind: 'failed', message: 'The server cannot be reached.' }] as const;
  const fresh: Note = { ...note('c', 'a crack'), position_m: [4, 5, 6] };
  const state = after(...open, click, typed('a crack '), ...lost);
  expect(reduceNoting(state, { kind: 'listed', notes: [...list.notes, fresh] })).toMatchObject({
    draft: null,
    chosen: 'c',
    problem: '',
  });
  expect(
    reduceNoting(state, { kind: 'listed', notes: [{ ...fresh, position_m: [4, 5, 6.1] }] }).draft,
  ).not.toBeNull();
  const changed = reduceNoting(after(...editing, lost[1]), {
    kind: 'listed',
    notes: [note('a', 'mine', 2)],
  });
  expect(changed).toMatchObject({ draft: null, chosen: 'a' });
  expect(
    after(...open, { kind: 'chosen', id: 'a' }, { kind: 'edited' }, list).draft,
  ).not.toBeNull();
});

test('while there are two texts, that question is repeated, and nothing is saved', () => {
  const state = after(...editing, conflict);
  expect(heldText(state.draft)).toContain('Which text is to stay?');
  expect(notingText(reduceNoting(state, click))).toContain('Which text is to stay?');
  expect(reduceNoting(state, saving)).toBe(state);
  expect(heldText(after(...open, click, typed('a crack')).draft)).toContain(
    'Save the note, or cancel',
  );
  expect([heldText(null), heldText(after(...open, click).draft)]).toEqual(['', '']);
});
