// What a person changes about scans, what they may change, and what the report says of one that has ended.
import { ApiError, isRecord, numberOf, request, scanPath } from './api';

const limit_ms = 10_000;

export interface Access {
  readonly view: boolean;
  readonly scan: boolean;
  readonly admin: boolean;
  readonly shared: boolean; // somebody came by a link to one scan
}

export const noAccess: Access = { view: false, scan: false, admin: false, shared: false };

const known = new Map<string, Promise<Access>>();

// Asked once a token: what it may do does not change, but it may end.
export function fetchAccess(token: string): Promise<Access> {
  let access = known.get(token);
  if (!access) {
    access = request('api/v1/access', token, { limit_ms })
      .then((response) => response.json())
      .then(parseAccess);
    known.clear(); // of tokens that were tried before nobody wants to know
    known.set(token, access);
    access.catch(() => known.delete(token));
  }
  return access;
}

export function parseAccess(json: unknown): Access {
  const scopes = isRecord(json) && Array.isArray(json['scopes']) ? json['scopes'] : null;
  if (!scopes) throw new ApiError('The server’s answer cannot be read.', false);
  const [view, scan, admin] = ['view', 'scan', 'admin'].map((scope) => scopes.includes(scope)) as [boolean, boolean, boolean];
  return { view, scan, admin, shared: typeof (json as Record<string, unknown>)['scan'] === 'string' };
}


export async function renameScan(scanId: string, title: string, token: string): Promise<void> {
  const headers = { 'Content-Type': 'application/json' };
  await request(scanPath(scanId), token, { limit_ms, method: 'PATCH', headers, body: JSON.stringify({ title }) });
}

// It ends as interrupted, with what it has.
export async function stopScan(scanId: string, token: string): Promise<void> {
  await request(`${scanPath(scanId)}/stop`, token, { limit_ms, method: 'POST' });
}

// `leaving`: the page goes, and the request must not go with it.
export async function deleteScan(scanId: string, token: string, leaving = false): Promise<void> {
  await request(scanPath(scanId), token, { limit_ms, method: 'DELETE', keepalive: leaving });
}

// Of a scan that has ended.
export interface Report {
  readonly surfels: number | null; // all of the map
  readonly cloudPoints: number | null; // those that were seen often enough; null from an older server
}

export async function fetchReport(scanId: string, token: string): Promise<Report> {
  const response = await request(`${scanPath(scanId)}/report.json`, token, { limit_ms });
  return parseReport(await response.json());
}

export function parseReport(json: unknown): Report {
  return isRecord(json) ? { surfels: numberOf(json['surfels']), cloudPoints: numberOf(json['cloud_points']) } : { surfels: null, cloudPoints: null };
}
