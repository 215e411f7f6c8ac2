import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { asItIs, type ScanExport } from '../connection/exports';
import { Downloads } from './downloads';

const plan: ScanExport = {
  format: 'dxf',
  of_format: 'dxf',
  finish: asItIs,
  kind: 'plan',
  label: 'DXF',
  file: 'plan.dxf',
  state: 'missing',
  size_bytes: 0,
  done: 0,
  words: '',
};

let listed: ScanExport[]; // what the server tells
let made: string[];
let saved: string[];
let said: string[];
let looking: boolean;
let lists: number; // how often it was asked
let downloads: Downloads;

beforeEach(() => {
  vi.useFakeTimers();
  [listed, made, saved, said, looking, lists] = [[plan], [], [], [], true, 0];
  downloads = new Downloads(
    {
      list: async () => {
        ++lists;
        return listed;
      },
      make: async (format) => {
        made.push(format);
        listed = [{ ...plan, state: 'running' }];
        return listed[0]!;
      },
      remove: async () => void (listed = [plan]),
      load: async (_, progress) => {
        progress(7);
        return new Blob();
      },
    },
    {
      show: () => {},
      say: (text) => void said.push(text),
      save: (_, { file }) => void saved.push(file),
      isLookedAt: () => looking,
    },
  );
});

afterEach(() => {
  downloads.dispose();
  vi.useRealTimers();
});

async function looked(): Promise<void> {
  downloads.look();
  await vi.advanceTimersByTimeAsync(0);
}

test('what is there is taken at once', async () => {
  listed = [{ ...plan, state: 'ready' }];
  await looked();
  await downloads.take(downloads.find('dxf'));
  expect([made, saved]).toEqual([[], ['plan.dxf']]);
  expect(downloads.loadedOf(plan)).toBe(null);
});

test('what is missing is made first and taken when it is ready, even if nobody looks', async () => {
  await looked();
  await downloads.take(downloads.find('dxf'));
  looking = false;
  await vi.advanceTimersByTimeAsync(10_000);
  expect([made, saved]).toEqual([['dxf'], []]);
  listed = [{ ...plan, state: 'ready' }];
  await vi.advanceTimersByTimeAsync(10_000);
  expect([made, saved]).toEqual([['dxf'], ['plan.dxf']]);
});

test('the server is asked while something is made and somebody looks', async () => {
  listed = [{ ...plan, state: 'running' }];
  await looked();
  await vi.advanceTimersByTimeAsync(10_000);
  expect(lists).toBeGreaterThan(5);
  looking = false;
  await vi.advanceTimersByTimeAsync(2_000);
  const before = lists;
  await vi.advanceTimersByTimeAsync(10_000);
  expect(lists).toBe(before);
});

test('what is removed, or has failed, is not waited for', async () => {
  await looked();
  await downloads.take(downloads.find('dxf'));
  await downloads.remove('dxf');
  listed = [{ ...plan, state: 'ready' }];
  await vi.advanceTimersByTimeAsync(10_000);
  expect(saved).toEqual([]);
});

test('why something did not work is said', async () => {
  listed = [{ ...plan, state: 'ready' }];
  await looked();
  const failing = new Downloads(
    {
      list: async () => listed,
      make: () => Promise.reject(new Error('')),
      remove: async () => {},
      load: async () => new Blob(),
    },
    { show: () => {}, say: (text) => void said.push(text), save: () => {}, isLookedAt: () => true },
  );
  await failing.take(plan);
  expect(said.at(-1)).not.toBe('');
  failing.dispose();
});

test('a page that is gone asks and saves no more', async () => {
  await looked();
  await downloads.take(downloads.find('dxf'));
  downloads.dispose();
  const before = lists;
  listed = [{ ...plan, state: 'ready' }];
  await vi.advanceTimersByTimeAsync(10_000);
  expect([saved, lists]).toEqual([[], before]);
});
