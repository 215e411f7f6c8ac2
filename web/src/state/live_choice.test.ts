import { describe, expect, it } from 'vitest';
import { liveIsWanted, storeLive } from './live_choice';

describe('the images of a running scan', () => {
  it('are seen until somebody closes them, then and later', () => {
    const kept = new Map<string, string>();
    const storage = {
      getItem: (name: string) => kept.get(name) ?? null,
      setItem: (name: string, value: string) => void kept.set(name, value),
    };
    expect(liveIsWanted(storage)).toBe(true);
    storeLive(storage, false);
    expect(liveIsWanted(storage)).toBe(false);
    storeLive(storage, true);
    expect(liveIsWanted(storage)).toBe(true);
  });
});
