import { expect, test } from 'vitest';
import type { FrameList } from '../connection/frames';
import { frameAfter, nextImage, OneAtATime, timeText, widened } from './frames';

// At 10 Hz, with a pause and two frames without an image.
const list: FrameList = {
  timestamps_s: [100, 100.1, null, 101.2, 101.3, null],
  statuses: ['tracked', 'weak', 'refused', 'lost', 'tracked', 'damaged'],
  reasons: ['', 'too fast', '', 'dark', '', ''],
};

test('frames play by the camera’s clock', () => {
  const played = [0, 0.05, 0.11, 1, 1.15, 1.21, 99].map((elapsed_s) =>
    frameAfter(list, 0, elapsed_s),
  );
  expect(played).toEqual([0, 0, 1, 1, 3, 4, 4]); // and the camera's pause of 1.1 s takes one
  expect(frameAfter(list, 3, 0.11)).toBe(4);
  expect(frameAfter(list, 2, 0)).toBe(3);
  expect(frameAfter(list, 5, 1)).toBe(5);
});

test('frames without an image are passed over', () => {
  expect([
    nextImage(list, 1, 1),
    nextImage(list, 3, -1),
    nextImage(list, 4, 1),
    nextImage(list, 0, -1),
  ]).toEqual([3, 1, 4, 0]);
});

test('times are since the first frame', () => {
  expect([0, 1, 2, 3].map((frame) => timeText(list, frame))).toEqual([
    '0:00.000',
    '0:00.100',
    '',
    '0:01.200',
  ]);
  expect(timeText({ ...list, timestamps_s: [0, 754.0335] }, 1)).toBe('12:34.034');
});

test('the range of depth grows in steps and never shrinks', () => {
  const first = widened(null, { from_mm: 412, to_mm: 1981 });
  expect(first).toEqual({ from_mm: 400, to_mm: 2000 });
  expect(widened(first, { from_mm: 800, to_mm: 900 })).toEqual(first);
  expect(widened(first, { from_mm: 250, to_mm: 3001 })).toEqual({ from_mm: 200, to_mm: 3100 });
  expect(widened(first, { from_mm: 0, to_mm: 0 })).toEqual(first);
  expect(widened(null, { from_mm: 500, to_mm: 500 })).toEqual({ from_mm: 500, to_mm: 600 });
});

// Fetches that are answered by hand.
function desk() {
  const asked: {
    which: number;
    signal: AbortSignal;
    answer: (item: string) => void;
    refuse: (error: Error) => void;
  }[] = [];
  const told: string[] = [];
  const one = new OneAtATime<string>(
    (which, signal) =>
      new Promise((answer, refuse) => asked.push({ which, signal, answer, refuse })),
    (which, item) => told.push(`${which} ${item}`),
    (which, error) => told.push(`${which} ${(error as Error).message}`),
  );
  return { asked, told, one };
}
const settle = () => new Promise((resolve) => setTimeout(resolve));

test('while one is on its way only the newest wish is kept', async () => {
  const { asked, told, one } = desk();
  for (const which of [1, 2, 3, 4]) one.want(which);
  expect(asked.map((ask) => ask.which)).toEqual([1]);
  asked[0]!.answer('a');
  await settle();
  expect(asked.map((ask) => ask.which)).toEqual([1, 4]);
  asked[1]!.refuse(new Error('no'));
  await settle();
  expect(told).toEqual(['1 a', '4 no']);
  expect(one.isBusy).toBe(false);
  one.want(5);
  expect(asked.length).toBe(3);
});

test('what was stopped is not told, and others can be wished for at once', async () => {
  const { asked, told, one } = desk();
  one.want(1);
  one.want(2);
  one.stop();
  expect(asked[0]!.signal.aborted).toBe(true);
  one.want(3);
  asked[0]!.answer('late');
  asked[1]!.answer('c');
  await settle();
  expect(told).toEqual(['3 c']);
  expect(asked.length).toBe(2);
});
