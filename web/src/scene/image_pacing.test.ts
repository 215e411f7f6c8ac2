import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { ImagePacing, type Motion } from './image_pacing';

// A browser whose images take `image_ms` from being asked for to being drawn.
let image_ms: number;
let motion: Motion;
let elapsed_ms: number[];
let pacing: ImagePacing;

beforeEach(() => {
  vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'performance'] });
  vi.stubGlobal('requestAnimationFrame', (draw: (now_ms: number) => void) =>
    setTimeout(() => draw(performance.now()), image_ms),
  );
  vi.stubGlobal('cancelAnimationFrame', (request: ReturnType<typeof setTimeout>) =>
    clearTimeout(request),
  );
  [image_ms, motion, elapsed_ms] = [10, 'none', []];
  pacing = new ImagePacing((elapsed) => {
    elapsed_ms.push(elapsed);
    return motion;
  });
});

afterEach(() => {
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

test('what is asked for twice before it is drawn is drawn once, and then all rests', () => {
  pacing.request();
  pacing.request();
  expect(pacing.isResting).toBe(false);
  vi.advanceTimersByTime(1000);
  expect(elapsed_ms).toHaveLength(1);
  expect(pacing.isResting).toBe(true);
});

test('after an idle time nothing leaps', () => {
  pacing.request();
  vi.advanceTimersByTime(60_000);
  pacing.request();
  vi.advanceTimersByTime(1000);
  expect(elapsed_ms[1]).toBe(400);
});

test('what moves is drawn again; the images of the last two seconds are counted', () => {
  motion = 'byItself';
  image_ms = 50;
  pacing.request();
  vi.advanceTimersByTime(4000);
  expect(pacing.framesPerSecond()).toBeGreaterThanOrEqual(20);
  expect(pacing.framesPerSecond()).toBeLessThanOrEqual(21);
});

test('where images are slow, what moves by itself waits, and a hand does not', () => {
  [motion, image_ms] = ['byItself', 400];
  pacing.request();
  vi.advanceTimersByTime(20_000);
  const byItself = elapsed_ms.length;
  expect(byItself).toBeLessThan(20);
  motion = 'byHand';
  pacing.request();
  vi.advanceTimersByTime(20_000);
  expect(elapsed_ms.length - byItself).toBeGreaterThan(2 * byItself);
});

test('whoever waits for an image is told once', () => {
  const told = vi.fn();
  pacing.whenDrawn(told);
  pacing.request();
  vi.advanceTimersByTime(10);
  pacing.request();
  vi.advanceTimersByTime(1000);
  expect(told.mock.calls).toEqual([[expect.any(Number)]]);
});

test('nothing is drawn for a scene that is gone', () => {
  pacing.request();
  pacing.dispose();
  pacing.request();
  vi.advanceTimersByTime(1000);
  expect(elapsed_ms).toEqual([]);
});
