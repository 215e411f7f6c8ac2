import { expect, test } from 'vitest';
import { storedUp, storeUp } from './up_choice';

function storage(text: string | null = null): Pick<Storage, 'getItem' | 'setItem'> {
  return { getItem: () => text, setItem: (_, value) => (text = value) };
}

test('what was said of a scan stays, of the last hundred', () => {
  const kept = storage();
  for (let i = 0; i < 101; ++i) storeUp(kept, `scan${i}`, [0, -1, 0]);
  storeUp(kept, 'scan50', [1, 0, 0]);
  expect(storedUp(kept, 'scan0')).toBeNull();
  expect(storedUp(kept, 'scan1')).toEqual([0, -1, 0]);
  expect(storedUp(kept, 'scan50')).toEqual([1, 0, 0]);
  storeUp(kept, 'scan50', null);
  expect(storedUp(kept, 'scan50')).toBeNull();
});

test('what is no direction is none', () => {
  for (const text of [
    '',
    '{',
    '{}',
    '[["a",[0,0,0]]]',
    '[["a",[0,-1]]]',
    '[["a",["0",-1,0]]]',
    '[[1,[0,-1,0]]]',
  ])
    expect(storedUp(storage(text), 'a')).toBeNull();
});
