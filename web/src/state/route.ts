// Which page the address bar's fragment means.

// `view`: a query, how the scan is looked at.
export type Route =
  | { readonly page: 'list' }
  | { readonly page: 'scan' | 'quality'; readonly scanId: string; readonly view: string }
  | { readonly page: 'compare'; readonly scanId: string; readonly other: string };

const scanPath = /^#\/scan\/([^/?&#]+)(?:\?([^#]*))?$/;
const quality = 'page=quality'; // a field like others, so that a share link may have it

export function routeOf(hash: string): Route {
  const [, scan, view = ''] = scanPath.exec(hash) ?? [];
  if (!scan) return { page: 'list' };
  try {
    const other = otherOf(view);
    if (other) return { page: 'compare', scanId: decodeURIComponent(scan), other };
    return {
      page: view.split('&').includes(quality) ? 'quality' : 'scan',
      scanId: decodeURIComponent(scan),
      view,
    };
  } catch {
    return { page: 'list' }; // a broken percent sign
  }
}

export function hashOf(scanId: string, view = ''): string {
  return `#/scan/${encodeURIComponent(scanId)}${view && `?${view}`}`;
}

// What has changed between two scans; the second one's id is a field of the address, too.
export const compareHash = (first: string, second: string): string =>
  hashOf(first, `page=compare&with=${encodeURIComponent(second)}`);

function otherOf(view: string): string {
  const fields = new URLSearchParams(view);
  return fields.get('page') === 'compare' ? (fields.get('with') ?? '') : '';
}

export const qualityHash = (scanId: string): string => hashOf(scanId, quality);

// The scan with this frame of its camera looked at.
export const frameHash = (scanId: string, frame: number): string =>
  hashOf(scanId, `frame=${frame}`);

// The frame that a view names, null when it names none.
export function frameOf(view: string): number | null {
  const frame = new URLSearchParams(view).get('frame') ?? '';
  return /^\d{1,9}$/.test(frame) ? Number(frame) : null;
}
