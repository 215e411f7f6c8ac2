import { describe, expect, it } from 'vitest';
import type { ScanEvent, ScanPhaseName } from '../connection/events';
import type { LiveScanEvent } from './live_scan';
import { receiver } from './receiver';

const chunk = (x: number, version: bigint, count: number): ScanEvent => ({
  kind: 'chunk',
  key: { submap: 0, level: 0, x, y: 0, z: 0 },
  version,
  points: count === 0 ? null : ({ count } as never),
});
const welcome: ScanEvent = { kind: 'welcome', title: '', camera: null };
const end: ScanEvent = { kind: 'snapshotEnd' };
const state = (phase: ScanPhaseName): ScanEvent => ({
  kind: 'scanState',
  phase,
  words: '',
  received: 0,
  processed: 0,
  dropped: 0,
  keyframes: 0,
  loops: 0,
  paused: false,
  canPause: false,
  up: null,
});

// Names of the chunks that the scene has.
function play(): {
  say: (...events: ScanEvent[]) => void;
  shown: Set<number>;
  content: () => { points: number; old: boolean };
} {
  const shown = new Set<number>();
  let content = { points: 0, old: false };
  const receive = receiver(
    (event: LiveScanEvent) => {
      if (event.kind === 'content') content = { points: event.points, old: event.old };
    },
    (event) => {
      if (event.kind !== 'chunk') return;
      if (event.points) shown.add(event.key.x);
      else shown.delete(event.key.x);
    },
  );
  return { say: (...events) => events.forEach(receive), shown, content: () => content };
}

describe('receiver', () => {
  it('keeps what was shown while a server that was started again builds the scan', () => {
    const { say, shown, content } = play();
    say(welcome, state('running'), chunk(0, 5n, 100), chunk(1, 5n, 100), chunk(2, 5n, 100), end);
    say(welcome, state('running'), end);
    expect([...shown]).toEqual([0, 1, 2]);
    expect(content()).toEqual({ points: 300, old: true });
    say(chunk(0, 1n, 90)); // it counts afresh
    expect([...shown].sort()).toEqual([0, 1, 2]);
    expect(content()).toEqual({ points: 290, old: true });
    say(chunk(3, 2n, 80)); // enough by now
    expect([...shown].sort()).toEqual([0, 3]);
    expect(content()).toEqual({ points: 170, old: false });
  });

  it('drops what a whole snapshot does not name', () => {
    const { say, shown } = play();
    say(welcome, state('running'), chunk(0, 5n, 100), chunk(1, 5n, 100), end);
    say(welcome, state('running'), chunk(0, 5n, 100), end);
    expect([...shown]).toEqual([0]);
  });

  it('waits for nothing more when the scan has ended', () => {
    const { say, shown, content } = play();
    say(welcome, state('running'), chunk(0, 5n, 100), chunk(1, 5n, 100), end);
    say(welcome, state('running'), chunk(0, 1n, 10), end);
    expect(shown.size).toBe(2);
    say(state('interrupted'));
    expect([...shown]).toEqual([0]);
    expect(content()).toEqual({ points: 10, old: false });
  });
});
