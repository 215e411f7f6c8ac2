import { describe, expect, it } from 'vitest';
import { storageOr } from './storages';

describe('storageOr', () => {
  it('is the browser’s, where that works', () => {
    const storage = storageOr(() => storageOr(() => undefined as never));
    storage.setItem('a', 'b');
    expect(storageOr(() => storage)).toBe(storage);
  });

  it('remembers while the page is open, where the browser refuses', () => {
    const storage = storageOr(() => {
      throw new DOMException('refused', 'SecurityError');
    });
    expect(storage.getItem('a')).toBeNull();
    storage.setItem('a', 'b');
    storage.setItem('c', 'd');
    expect(storage.getItem('a')).toBe('b');
    expect([storage.length, storage.key(0), storage.key(1), storage.key(2)]).toEqual([
      2,
      'a',
      'c',
      null,
    ]);
    storage.removeItem('a');
    expect(storage.getItem('a')).toBeNull();
  });
});
