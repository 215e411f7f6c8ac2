import { expect, test } from 'vitest';
import type { FrameEvent } from '../connection/events';
import { keepReason, reasonOf } from './reasons';

test('reasons that were seen are found by their frames', () => {
  const frame = (sequence: number, tracking: FrameEvent['tracking'], reason: string) =>
    keepReason('a', { kind: 'frame', sequence, tracking, reason } as FrameEvent);
  frame(3, 'tracked', '');
  frame(4, 'weak', 'too fast');
  for (const sequence of [5, 6, 7]) frame(sequence, 'lost', 'occluded');
  expect(reasonOf('a', 4, 9)).toBe('occluded');
  expect(reasonOf('a', 0, 4)).toBe('too fast');
  expect(reasonOf('a', 8, 9)).toBe('');
  expect(reasonOf('b', 0, 9)).toBe('');
});
