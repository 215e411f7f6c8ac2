import { expect, test } from 'vitest';
import type { Note, NoteView } from '../connection/notes';
import { storeDraft, storedDraft } from './note_drafts';
import type { Draft } from './noting';

const view: NoteView = { position_m: [0, 0, -1], target_m: [0, 0, 1] };
const note: Note = { id: 'a', position_m: [1, 2, 3], view, text: 'old', version: 4, changed: null };
const fresh: Draft = { of: null, position_m: [4, 5, 6], view, text: 'a crack\n ', theirs: null };

function storage(text: string | null = null): Pick<Storage, 'getItem' | 'setItem'> {
  return { getItem: () => text, setItem: (_, value) => (text = value) };
}

test('a new note and a change come back as they were written, each in its scan', () => {
  const kept = storage();
  storeDraft(kept, 'one', fresh);
  storeDraft(kept, 'two', { ...fresh, of: note, view: null, theirs: { ...note, version: 5 } });
  expect(storedDraft(kept, 'one')).toEqual(fresh);
  expect(storedDraft(kept, 'two')).toEqual({ ...fresh, of: note, view: null });
  expect(storedDraft(kept, 'three')).toBeNull();
});

test('what was saved or cancelled is not kept, nor what has no text of its own', () => {
  const kept = storage();
  for (const ended of [null, { ...fresh, text: ' ' }, { ...fresh, of: note, text: 'old' }]) {
    storeDraft(kept, 'one', fresh);
    storeDraft(kept, 'one', ended);
    expect(kept.getItem('')).toBe('[]');
  }
});

test('the last twenty scans are kept, and so much of a text', () => {
  const kept = storage();
  for (let i = 0; i < 21; ++i) storeDraft(kept, `scan${i}`, { ...fresh, text: 'm'.repeat(20_000) });
  expect(storedDraft(kept, 'scan0')).toBeNull();
  expect(storedDraft(kept, 'scan1')?.text).toHaveLength(10_000);
});

test('what cannot be read is no draft, and does not keep another one from being kept', () => {
  const bad = [
    '',
    '{',
    '{}',
    '[["a"]]',
    '[["a",{}]]',
    '[["a",{"position_m":[0,0],"text":"t","of":null}]]',
    '[["a",{"position_m":[0,0,1],"text":"t","of":{}}]]',
    '[["a",{"position_m":[0,0,1],"text":7,"of":null}]]',
  ];
  for (const text of bad) {
    const kept = storage(text);
    expect(storedDraft(kept, 'a')).toBeNull();
    storeDraft(kept, 'a', fresh);
    expect(storedDraft(kept, 'a')).toEqual(fresh);
  }
  const closed = {
    getItem: () => {
      throw new Error('forbidden');
    },
    setItem: () => {
      throw new Error('full');
    },
  };
  storeDraft(closed, 'a', fresh);
  expect(storedDraft(closed, 'a')).toBeNull();
});
