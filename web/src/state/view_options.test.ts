import { describe, expect, it } from 'vitest';
import { storedShow, storeShow } from './view_options';

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
