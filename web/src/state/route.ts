// Which page the address bar's fragment means.

export type Route = { readonly page: 'list' } | { readonly page: 'scan'; readonly scanId: string };

const scanPath = /^#\/scan\/([^/?&#]+)$/;

export function routeOf(hash: string): Route {
  const scan = scanPath.exec(hash)?.[1];
  if (!scan) return { page: 'list' };
  try {
    return { page: 'scan', scanId: decodeURIComponent(scan) };
  } catch {
    return { page: 'list' }; // a broken percent sign
  }
}

export function hashOf(scanId: string): string {
  return `#/scan/${encodeURIComponent(scanId)}`;
}
