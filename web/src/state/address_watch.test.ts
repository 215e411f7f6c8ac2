import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { watchAddress } from './address_watch';
import { createStore } from './store';

const replaceState = vi.fn();

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal('history', { replaceState });
  replaceState.mockClear();
});

afterEach(() => {
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

function watched() {
  const store = createStore('', (_, query: string) => query);
  return { store, stop: watchAddress('one', store.get, [store]) };
}

test('the address follows when what is seen rests, and not while it is dragged', () => {
  const { store } = watched();
  for (const query of ['clip=1', 'clip=2', 'clip=3']) {
    store.dispatch(query);
    vi.advanceTimersByTime(100);
  }
  expect(replaceState).not.toHaveBeenCalled();
  vi.advanceTimersByTime(1000);
  expect(replaceState.mock.calls).toEqual([[null, '', '#/scan/one?clip=3']]);
  store.dispatch('');
  vi.advanceTimersByTime(1000);
  expect(replaceState).toHaveBeenLastCalledWith(null, '', '#/scan/one');
});

test('an address that says it already stays, and so does that of a page that is gone', () => {
  const { store, stop } = watched();
  store.dispatch('clip=1');
  store.dispatch('');
  vi.advanceTimersByTime(1000);
  store.dispatch('clip=1');
  stop();
  vi.advanceTimersByTime(1000);
  expect(replaceState).not.toHaveBeenCalled();
});
