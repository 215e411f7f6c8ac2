// The HTTP side of the server: the list of scans and the files of one. Failures are ApiErrors with
// a message; every request ends after a time limit.
import { t } from '../texts/texts';
import type { ScanPhaseName } from './events';
import { serverClock } from './server_clock';

const listLimit_ms = 10_000;

export interface ScanSummary {
  readonly id: string;
  readonly title: string;
  readonly tags: readonly string[];
  readonly phase: ScanPhaseName;
  readonly words: string; // why it failed, or empty
  readonly frameCount: number; // that were used
  readonly droppedCount: number;
  readonly imported: boolean; // a cloud or mesh of another program: no camera has seen it
  readonly started: Date | null;
  readonly ended: Date | null; // null while it runs
}

export class ApiError extends Error {
  constructor(
    message: string,
    readonly unauthorized: boolean,
    readonly passing = false, // trying again may help
    readonly missing = false, // the server has no such thing, or no longer
  ) {
    super(message);
  }
}

// What people are told of a failed request.
export const errorText = (error: unknown, otherwise = t.thatDidNotWork): string =>
  error instanceof ApiError ? error.message : otherwise;

export interface ScanList {
  readonly scans: readonly ScanSummary[]; // newest first
  readonly more: boolean; // there may be older ones
}

// The newest, or those next to a scan of that id.
export async function fetchScans(token: string, olderThan = ''): Promise<ScanList> {
  const query = olderThan === '' ? '' : `?older-than=${encodeURIComponent(olderThan)}`;
  const response = await request(`api/v1/scans${query}`, token, { limit_ms: listLimit_ms });
  return parseScans(await response.json());
}

export async function fetchScan(scanId: string, token: string): Promise<ScanSummary> {
  const response = await request(scanPath(scanId), token, { limit_ms: listLimit_ms });
  return parseScan(await response.json());
}

// Of one scan, as it is and after a change of it.
export function parseScan(json: unknown): ScanSummary {
  if (!isRecord(json) || typeof json['id'] !== 'string')
    throw new ApiError(t.theServersAnswerCannotBeRead, false);
  return summaryOf(json);
}

// And those of `known` that are older than all of these: what was removed
// among the newer ones is gone.
export function withOlder(
  newer: readonly ScanSummary[],
  known: readonly ScanSummary[],
): ScanSummary[] {
  const ids = new Set(newer.map((scan) => scan.id));
  const last_ms = newer.at(-1)?.started?.getTime() ?? Infinity;
  return [
    ...newer,
    ...known.filter((scan) => !ids.has(scan.id) && (scan.started?.getTime() ?? 0) <= last_ms),
  ];
}

// A link cannot carry the token, hence what is saved was fetched before.
export function saveAs(blob: Blob, name: string): void {
  const url = URL.createObjectURL(blob);
  const link = document.createElement('a');
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

// Of all that belongs to one scan.
export const scanPath = (scanId: string): string => `api/v1/scans/${encodeURIComponent(scanId)}`;

// The address of a new share link: whoever has it may look at this scan, and at
// nothing else, until it expires.
export async function createShareLink(
  scanId: string,
  token: string,
  wanted?: { readonly name: string; readonly days: number },
): Promise<string> {
  const said = wanted
    ? { headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(wanted) }
    : {};
  const response = await request(`${scanPath(scanId)}/shares`, token, {
    limit_ms: listLimit_ms,
    method: 'POST',
    ...said,
  });
  return shareLinkOf(await response.json(), location);
}

// The server knows the path, the page knows where it is (behind a proxy, perhaps below a folder).
export function shareLinkOf(json: unknown, page: Pick<Location, 'origin' | 'pathname'>): string {
  const path = isRecord(json) ? json['path'] : null;
  if (typeof path !== 'string' || !path.startsWith('/#share='))
    throw new ApiError(t.theServersAnswerCannotBeRead, false);
  return page.origin + page.pathname.replace(/[^/]*$/, '') + path.slice(1);
}

export function fileNameOf(title: string): string {
  return title
    .normalize('NFKD')
    .replace(/[^A-Za-z0-9._-]+/g, '_')
    .replace(/^[._]+|[._]+$/g, '')
    .slice(0, 80);
}

export interface Asking {
  readonly limit_ms: number;
  readonly method?: string;
  readonly headers?: Readonly<Record<string, string>>;
  readonly body?: string;
  readonly signal?: AbortSignal; // somebody may want no answer any more
  readonly keepalive?: boolean; // it outlives the page
  // Statuses that are no failure, though they are no success either.
  readonly expected?: readonly number[];
}

export async function request(
  path: string,
  token: string,
  {
    limit_ms,
    method = 'GET',
    headers = {},
    body,
    signal,
    keepalive = false,
    expected = [],
  }: Asking,
): Promise<Response> {
  const limit = AbortSignal.timeout(limit_ms);
  let response: Response;
  try {
    response = await fetch(path, {
      method,
      keepalive,
      headers: { Authorization: `Bearer ${token}`, ...headers },
      signal: signal ? AbortSignal.any([limit, signal]) : limit,
      ...(body === undefined ? {} : { body }),
    });
  } catch {
    throw new ApiError(t.theServerCannotBeReached, false, true);
  }
  serverClock.hear(response.headers, Date.now());
  if (expected.includes(response.status)) return response;
  if (response.status === 401) throw new ApiError(t.theServerDoesNotAcceptThis, true);
  if (response.status === 403) throw new ApiError(t.thisAccessTokenDoesNotAllow, true);
  if (response.status === 429) throw new ApiError(t.theServerAsksToWaitA, false, true);
  if (response.status === 404) throw new ApiError(t.theServerDoesNotHaveThis, false, false, true);
  if (!response.ok)
    throw new ApiError(
      refusalOf(await response.text().catch(() => ''), response.status),
      false,
      response.status === 409 || response.status >= 500,
    );
  return response;
}

// The server's own message, which names what is wrong and the limit.
export function refusalOf(body: string, status: number): string {
  try {
    const json: unknown = JSON.parse(body);
    const error = isRecord(json) ? json['error'] : null;
    if (isRecord(error) && textOf(error['message']))
      return t.theServerSays(textOf(error['message']));
  } catch {
    // No JSON: a proxy has answered.
  }
  return t.theServerAnsweredWithHttp(status);
}

// Rows that are not scans are left out.
export function parseScans(json: unknown): ScanList {
  const rows = isRecord(json) && Array.isArray(json['scans']) ? json['scans'] : null;
  if (!rows) throw new ApiError(t.theServersListOfScansCannot, false);
  const scans = rows
    .filter(isRecord)
    .filter((row) => typeof row['id'] === 'string')
    .map(summaryOf);
  scans.sort((a, b) => (b.started?.getTime() ?? 0) - (a.started?.getTime() ?? 0));
  return { scans, more: isRecord(json) && json['more'] === true };
}

function summaryOf(row: Record<string, unknown>): ScanSummary {
  const id = String(row['id']);
  return {
    id,
    title: textOf(row['title']) || t.untitledScan,
    tags: Array.isArray(row['tags']) ? row['tags'].map(textOf).filter(Boolean) : [],
    phase: phaseOf(row['state']),
    words: textOf(row['words']),
    frameCount: numberOf(row['frames_processed']) ?? 0,
    droppedCount: numberOf(row['frames_dropped']) ?? 0,
    imported: row['width'] === 0,
    started: dateOf(row['created_at']),
    ended: dateOf(row['finished_at']),
  };
}

function phaseOf(value: unknown): ScanPhaseName {
  return value === 'running' ||
    value === 'finished' ||
    value === 'failed' ||
    value === 'interrupted'
    ? value
    : 'unknown';
}

export const textOf = (value: unknown): string => (typeof value === 'string' ? value : '');
export const numberOf = (value: unknown): number | null =>
  typeof value === 'number' && Number.isFinite(value) ? value : null;

function dateOf(value: unknown): Date | null {
  const time_ms = typeof value === 'string' ? Date.parse(value) : NaN;
  return Number.isNaN(time_ms) ? null : new Date(time_ms);
}

export function isRecord(value: unknown): value is Record<string, unknown> {
  return typeof value === 'object' && value !== null;
}
