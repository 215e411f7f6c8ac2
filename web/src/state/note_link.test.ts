import { expect, test } from 'vitest';
import { noteQuery, readNote } from './note_link';

const id = 'a1'.repeat(13);

test('the chosen note is a field of the address', () => {
  expect(noteQuery(id)).toBe(`note=${id}`);
  expect(readNote(`axes=1&${noteQuery(id)}`)).toBe(id);
  expect(noteQuery(null)).toBe('');
});

test('what is no id is no note', () => {
  for (const query of ['', 'note=', 'note=../shares', `note=${id}a`, `note=${id.toUpperCase()}`])
    expect(readNote(query)).toBeNull();
});
