// The access token arrives once in the fragment (#token=…, which browsers never send to a server),
// lives in this tab's sessionStorage, and leaves the address bar at once so that it is not copied
// or bookmarked by accident. A share link (#share=…&scan=ID) is a token that opens one scan. Other
// fields say how the scan is looked at, and stay.

const storageKey = 'hermite.token';

export interface Fragment {
  readonly token: string | null;
  readonly hash: string; // what the address bar should show
}

// '#token=T' -> '#/', '#token=T&scan=ID' and '#share=T&scan=ID' -> '#/scan/ID', '…&clip=C' ->
// '#/scan/ID?clip=C', anything else is left alone.
export function readFragment(hash: string): Fragment {
  const kind = /^#(token|share)=/.exec(hash)?.[1];
  if (!kind) return { token: null, hash };
  const fields = new URLSearchParams(hash.slice(1));
  const scan = fields.get('scan');
  const token = fields.get(kind) || null;
  for (const name of ['token', 'share', 'scan']) fields.delete(name);
  const view = fields.toString().replaceAll('%2C', ',');
  return { token, hash: scan ? `#/scan/${encodeURIComponent(scan)}${view && `?${view}`}` : '#/' };
}

export type TokenStorage = Pick<Storage, 'getItem' | 'setItem'>;

export function storedToken(storage: TokenStorage): string {
  return storage.getItem(storageKey) ?? '';
}

export function storeToken(storage: TokenStorage, token: string): void {
  storage.setItem(storageKey, token.trim());
}
