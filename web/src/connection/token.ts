// The access token arrives once in the fragment (#token=…, which browsers never send to a server), lives in this tab's sessionStorage, and
// leaves the address bar at once so that it is not copied or bookmarked by accident. A share link (#share=…&scan=ID) is a token that opens
// one scan.

const storageKey = 'hermite.token';

export interface Fragment {
  readonly token: string | null;
  readonly hash: string; // what the address bar should show
}

// '#token=T' -> '#/', '#token=T&scan=ID' and '#share=T&scan=ID' -> '#/scan/ID', anything else is left alone.
export function readFragment(hash: string): Fragment {
  const kind = /^#(token|share)=/.exec(hash)?.[1];
  if (!kind) return { token: null, hash };
  const fields = new URLSearchParams(hash.slice(1));
  const scan = fields.get('scan');
  return { token: fields.get(kind) || null, hash: scan ? `#/scan/${encodeURIComponent(scan)}` : '#/' };
}

export type TokenStorage = Pick<Storage, 'getItem' | 'setItem'>;

export function storedToken(storage: TokenStorage): string {
  return storage.getItem(storageKey) ?? '';
}

export function storeToken(storage: TokenStorage, token: string): void {
  storage.setItem(storageKey, token.trim());
}
