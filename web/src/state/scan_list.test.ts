import { expect, test } from 'vitest';
import type { ScanSummary } from '../connection/api';
import { found, sorted } from './scan_list';

const scan = (title: string, frameCount: number): ScanSummary => ({
  id: title,
  title,
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

test('scans are in the order asked for', () => {
  expect(titles(sorted(scans, 'newest'))).toEqual(['Küche 10', 'kitchen 9', 'Attic']);
  expect(titles(sorted(scans, 'oldest'))).toEqual(['Attic', 'kitchen 9', 'Küche 10']);
  expect(titles(sorted(scans, 'title'))).toEqual(['Attic', 'kitchen 9', 'Küche 10']);
  expect(titles(sorted([scan('room 10', 0), scan('Room 9', 0)], 'title'))).toEqual(['Room 9', 'room 10']);
  expect(titles(sorted(scans, 'frames'))).toEqual(['kitchen 9', 'Küche 10', 'Attic']);
});
