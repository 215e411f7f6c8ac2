import { describe, expect, it } from 'vitest';
import { asksForSurface, initialViewOptions, storedShow, storeShow, watchOf } from './view_options';

describe('what is shown', () => {
  it('stays chosen', () => {
    const kept = new Map<string, string>();
    const storage = {
      getItem: (name: string) => kept.get(name) ?? null,
      setItem: (name: string, value: string) => void kept.set(name, value),
    };
    expect(storedShow(storage)).toBe('surface');
    storeShow(storage, 'points');
    expect(storedShow(storage)).toBe('points');
    storeShow(storage, 'surface');
    expect(storedShow(storage)).toBe('surface');
  });
  it('is the surface where something else was stored, or nothing can be', () => {
    expect(storedShow({ getItem: () => 'fog' })).toBe('surface');
    const full = {
      setItem: () => {
        throw new Error('quota');
      },
    };
    expect(() => storeShow(full, 'points')).not.toThrow();
  });
});

describe('coverage', () => {
  const covered = { ...initialViewOptions, coverage: true };
  const onPoints = { ...covered, show: 'points' } as const;
  it('is on the surface where that has confidences, and on points where they are chosen', () => {
    expect(asksForSurface(covered, true)).toBe(true);
    expect(asksForSurface(covered, false)).toBe(false);
    expect(asksForSurface(onPoints, true)).toBe(false);
    expect(asksForSurface(initialViewOptions, false)).toBe(true);
  });
  it('asks for what it is shown on, and for both until it is known what the surface has', () => {
    expect(watchOf(covered, true)).toEqual({ points: false, mesh: true });
    expect(watchOf(covered, false)).toEqual({ points: true, mesh: false });
    expect(watchOf(covered, null)).toEqual({ points: true, mesh: true });
    expect(watchOf(onPoints, null)).toEqual({ points: true, mesh: false });
    expect(watchOf(initialViewOptions, null)).toEqual({ points: false, mesh: true });
  });
});
