import { expect, test } from 'vitest';
import type { FrameList, FrameStatus } from '../connection/frames';
import { reasonOf } from './reasons';

const listOf = (...frames: readonly (readonly [FrameStatus, string])[]): FrameList => ({
  timestamps_s: frames.map((_, i) => i / 10),
  statuses: frames.map(([status]) => status),
  reasons: frames.map(([, reason]) => reason),
});

test('the most frequent reason stands for a stretch', () => {
  const list = listOf(
    ['tracked', ''],
    ['weak', 'too fast'],
    ['lost', 'dark'],
    ['lost', 'occluded'],
    ['lost', 'occluded'],
    ['weak', 'dark'],
  );
  expect(reasonOf(list, { follow: 'lost', first: 1, last: 5 })).toBe('occluded');
  // Of reasons as frequent as each other the first one counts.
  expect(reasonOf(list, { follow: 'lost', first: 2, last: 3 })).toBe('dark');
  expect(reasonOf(list, { follow: 'weak', first: 1, last: 1 })).toBe('too fast');
  expect(reasonOf(list, { follow: 'weak', first: 0, last: 0 })).toBe('');
});

test('a lost stretch has no reason of the doubtful frames around it', () => {
  const list = listOf(['weak', 'dark'], ['weak', 'dark'], ['lost', 'too fast'], ['weak', 'dark']);
  expect(reasonOf(list, { follow: 'lost', first: 0, last: 3 })).toBe('too fast');
  expect(
    reasonOf(
      { ...list, reasons: ['dark', 'dark', '', 'dark'] },
      { follow: 'lost', first: 0, last: 3 },
    ),
  ).toBe('');
});

test('reasons that differ in their numbers only count together', () => {
  const used = (percent: number): [FrameStatus, string] => [
    'weak',
    `only ${percent} % can be used`,
  ];
  const list = listOf(used(3), ['weak', 'dark'], used(4), ['weak', 'dark'], used(4));
  expect(reasonOf(list, { follow: 'weak', first: 0, last: 4 })).toBe('only 4 % can be used');
});
