import { expect, test } from 'vitest';
import { delayOf, parseFrames, parseRange, posesOf } from './frames';

test('runs of statuses become one for each frame', () => {
  const json = {
    timestamps_s: [0, 0.1, null, 0.3],
    statuses: [
      { status: 'tracked', frames: 2 },
      { status: 'refused', frames: 1 },
      { status: 'of tomorrow', frames: 9 },
    ],
  };
  expect(parseFrames(json)).toEqual({
    timestamps_s: [0, 0.1, null, 0.3],
    statuses: ['tracked', 'tracked', 'refused', 'unknown'],
    reasons: ['', '', '', ''],
  });
  expect(parseFrames({ timestamps_s: [0, 1], statuses: [{ frames: 'x' }] }).statuses).toEqual([
    'unknown',
    'unknown',
  ]);
  for (const wrong of [null, {}, { timestamps_s: [0] }, { timestamps_s: 5, statuses: [] }])
    expect(() => parseFrames(wrong)).toThrow();
});

test('reasons are told of the frames that they are for', () => {
  const read = (reasons: unknown) =>
    parseFrames({ timestamps_s: [0, 1, 2, 3, 4], statuses: [], reasons }).reasons;
  const fast = { reason: 'too fast', first: [0, 3], frames: [2, 1] };
  expect(read([fast, { reason: 'dark', first: [4], frames: [99] }])).toEqual([
    'too fast',
    'too fast',
    '',
    'too fast',
    'dark',
  ]);
  for (const wrong of [
    null,
    'x',
    [null],
    [{ ...fast, reason: 5 }],
    [{ ...fast, frames: 5 }],
    [{ ...fast, frames: [] }],
  ])
    expect(read(wrong)).toEqual(['', '', '', '', '']);
  expect(read([{ reason: 'dark', first: [-3, 'x', 9, 1], frames: [1, 1, 1, -1] }])).toEqual([
    '',
    '',
    '',
    '',
    '',
  ]);
});

test('a range of depth is read from its header', () => {
  expect(parseRange('412-3981')).toEqual({ from_mm: 412, to_mm: 3981 });
  for (const wrong of [null, '', '412', '-1-5', '1-2x'])
    expect(parseRange(wrong)).toEqual({ from_mm: 0, to_mm: 0 });
});

test('a delay is a whole number of milliseconds, or unknown', () => {
  expect(delayOf('0')).toBe(0);
  expect(delayOf('1234')).toBe(1234);
  for (const wrong of [null, '', '-1', '1.5', '1e9', '9999999999'])
    expect(delayOf(wrong)).toBeNull();
});

test('poses are those of the same time, to the microsecond', () => {
  const path =
    '# of a camera\n0.000000 1 0 0 0 0 0 1\n' +
    '0.066667 2 0 0 0 0 0 1\n0.100000 3 0 0 0 0 1 0\n0.2 x\n';
  const poses = posesOf(path, [0, 1 / 30, 2 / 30, null, 0.1, 0.2, 5]);
  expect(poses.map((pose) => pose?.translation[0] ?? null)).toEqual([
    1,
    null,
    2,
    null,
    3,
    null,
    null,
  ]);
  expect(poses[4]!.rotation).toEqual([0, 0, 1, 0]);
  expect(posesOf('', [0, 1])).toEqual([null, null]);
});
