import { expect, test } from 'vitest';
import type { ScanSummary } from '../connection/api';
import { found, sorted, tagged, tagsIn, tagsOf } from './scan_list';

const scan = (title: string, frameCount: number, tags: string[] = []): ScanSummary => ({
  id: title,
  title,
  tags,
  phase: 'finished',
  words: '',
  frameCount,
  droppedCount: 0,
  imported: false,
  started: null,
  ended: null,
});
const scans = [scan('Küche 10', 5), scan('kitchen 9', 70), scan('Attic', 5)];
const titles = (some: readonly ScanSummary[]): string[] => some.map(({ title }) => title);

test('words are found wherever they stand, without accents and case', () => {
  expect(titles(found(scans, 'KUCHE'))).toEqual(['Küche 10']);
  expect(titles(found(scans, ' 9  kit '))).toEqual(['kitchen 9']);
  expect(titles(found(scans, ''))).toEqual(titles(scans));
  expect(found(scans, 'kitchen 10')).toEqual([]);
});

test('scans are found by their tags', () => {
  const some = [scan('a', 1, ['House 10', 'old']), scan('b', 1, ['House 9']), scan('c', 1)];
  expect(titles(found(some, 'house'))).toEqual(['a', 'b']);
  expect(titles(tagged(some, new Set(['House 10', 'old'])))).toEqual(['a']);
  expect(titles(tagged(some, new Set()))).toEqual(['a', 'b', 'c']);
  expect(tagsOf(some)).toEqual(['House 9', 'House 10', 'old']);
  expect(tagsIn(' House 9, old;;old ,')).toEqual(['House 9', 'old']);
});

test('scans are in the order asked for', () => {
  expect(titles(sorted(scans, 'newest'))).toEqual(['Küche 10', 'kitchen 9', 'Attic']);
  expect(titles(sorted(scans, 'oldest'))).toEqual(['Attic', 'kitchen 9', 'Küche 10']);
  expect(titles(sorted(scans, 'title'))).toEqual(['Attic', 'kitchen 9', 'Küche 10']);
  expect(titles(sorted([scan('room 10', 0), scan('Room 9', 0)], 'title'))).toEqual([
    'Room 9',
    'room 10',
  ]);
  expect(titles(sorted(scans, 'frames'))).toEqual(['kitchen 9', 'Küche 10', 'Attic']);
});
