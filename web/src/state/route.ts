// Which page the address bar's fragment means.

export type Route = { readonly page: 'list' } | { readonly page: 'scan'; readonly scanId: string; readonly view: string }; // `view`: a query

const scanPath = /^#\/scan\/([^/?&#]+)(?:\?([^#]*))?$/;

export function routeOf(hash: string): Route {
  const [, scan, view = ''] = scanPath.exec(hash) ?? [];
  if (!scan) return { page: 'list' };
  try {
    return { page: 'scan', scanId: decodeURIComponent(scan), view };
  } catch {
    return { page: 'list' }; // a broken percent sign
  }
}

export function hashOf(scanId: string, view = ''): string {
  return `#/scan/${encodeURIComponent(scanId)}${view && `?${view}`}`;
}
