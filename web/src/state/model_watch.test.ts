import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import type { Axes } from './axes';
import {
  initialCutting,
  reduceCutting,
  type Cutting,
  type CuttingEvent,
  type Model,
} from './cutting';
import { initialLiveScan, type LiveScan } from './live_scan';
import { ModelWatch } from './model_watch';
import { createStore } from './store';

const axes: Axes = { along: [1, 0, 0], up: [0, -1, 0] };
const model = { low_m: [0, 0, 0], high_m: [1, 1, 1], axes, floor_m: 0 } as const satisfies Model;
const growing: LiveScan = { ...initialLiveScan('a'), phase: 'running', points: 10 };

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

function watched(cutting: Cutting) {
  const scene = { measureModel: vi.fn(() => null as Model | null), surface: 'points' as never };
  const store = createStore<Cutting, CuttingEvent>(cutting, reduceCutting);
  return { scene, store, watch: new ModelWatch(scene, store) };
}

test('nothing is measured while neither the panel, the box nor the plane is in use', () => {
  const { scene, watch } = watched(initialCutting);
  watch.follow(growing);
  expect(scene.measureModel).not.toHaveBeenCalled();
});

test('a model that grows is measured every two seconds, not at every change', () => {
  const { scene, watch } = watched({ ...initialCutting, active: true, model });
  for (let i = 0; i < 50; ++i) {
    watch.follow(growing);
    vi.advanceTimersByTime(100);
  }
  expect(scene.measureModel).toHaveBeenCalledTimes(3);
});

test('another surface is measured at once', () => {
  const { scene, watch } = watched({ ...initialCutting, active: true, model });
  watch.follow(growing);
  watch.follow(growing);
  scene.surface = 'finished' as never;
  watch.follow(growing);
  expect(scene.measureModel).toHaveBeenCalledTimes(2);
});

test('a box that is in use stays along its axes', () => {
  const { scene, store, watch } = watched({ ...initialCutting, axes });
  watch.measure();
  expect(scene.measureModel).toHaveBeenLastCalledWith(null);
  store.dispatch({ kind: 'measured', model });
  store.dispatch({ kind: 'clip', on: true });
  watch.measure();
  expect(scene.measureModel).toHaveBeenLastCalledWith(store.get().axes);
  expect(store.get().clip).not.toBe(null);
});
