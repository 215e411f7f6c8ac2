// The browser's storages. In a frame of another site it may refuse them: then things are remembered
// as long as the page is open.

export type SomeStorage = Pick<Storage, 'getItem' | 'setItem' | 'removeItem' | 'length' | 'key'>;

export function storageOr(open: () => SomeStorage): SomeStorage {
  try {
    const storage = open();
    storage.getItem('');
    return storage;
  } catch {
    return new PageStorage();
  }
}

// Forgets all when the page is closed.
export class PageStorage implements SomeStorage {
  private readonly values = new Map<string, string>();

  get length(): number {
    return this.values.size;
  }
  key(index: number): string | null {
    return [...this.values.keys()][index] ?? null;
  }
  getItem(key: string): string | null {
    return this.values.get(key) ?? null;
  }
  setItem(key: string, value: string): void {
    this.values.set(key, value);
  }
  removeItem(key: string): void {
    this.values.delete(key);
  }
}

export const ofThisTab = storageOr(() => sessionStorage);
export const ofThisBrowser = storageOr(() => localStorage);
