// What a person changes about scans, what they may change, and what the report
// says of one that has ended.
import { t } from '../texts/texts';
import {
  ApiError,
  isRecord,
  numberOf,
  parseScan,
  request,
  scanPath,
  textOf,
  type ScanSummary,
} from './api';
import type { MeasuredUp } from './events';

const limit_ms = 10_000;

export interface Access {
  readonly view: boolean;
  readonly scan: boolean;
  readonly admin: boolean;
  readonly shared: boolean; // somebody came by a link to one scan
  readonly embedding: boolean; // pages of other sites may show scans
}

export const noAccess: Access = {
  view: false,
  scan: false,
  admin: false,
  shared: false,
  embedding: false,
};

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
  if (!scopes) throw new ApiError(t.theServersAnswerCannotBeRead, false);
  const [view, scan, admin] = ['view', 'scan', 'admin'].map((scope) => scopes.includes(scope)) as [
    boolean,
    boolean,
    boolean,
  ];
  const { scan: sharedScan, embedding } = json as Record<string, unknown>;
  return {
    view,
    scan,
    admin,
    shared: typeof sharedScan === 'string',
    embedding: embedding === true,
  };
}

export interface Labels {
  readonly title?: string;
  readonly tags?: readonly string[]; // instead of those that it has
}

// What the server has of it then: it sorts tags.
export async function labelScan(
  scanId: string,
  labels: Labels,
  token: string,
): Promise<ScanSummary> {
  const headers = { 'Content-Type': 'application/json' };
  const response = await request(scanPath(scanId), token, {
    limit_ms,
    method: 'PATCH',
    headers,
    body: JSON.stringify(labels),
  });
  return parseScan(await response.json());
}

// It ends as interrupted, with what it has.
export async function stopScan(scanId: string, token: string): Promise<void> {
  await request(`${scanPath(scanId)}/stop`, token, { limit_ms, method: 'POST' });
}

// Asks the camera of a running scan to pause, or to go on, which it tells those who watch.
export async function pauseScan(scanId: string, pause: boolean, token: string): Promise<void> {
  await request(`${scanPath(scanId)}/${pause ? 'pause' : 'unpause'}`, token, {
    limit_ms,
    method: 'POST',
  });
}

// `leaving`: the page goes, and the request must not go with it.
export async function deleteScan(scanId: string, token: string, leaving = false): Promise<void> {
  await request(scanPath(scanId), token, { limit_ms, method: 'DELETE', keepalive: leaving });
}

// Of a scan that has ended. Null: an older server, or an import, does not say it.
export interface Report {
  readonly surfels: number | null; // all of the map
  readonly cloudPoints: number | null; // those that were seen often enough
  readonly frames: number | null; // that were processed
  readonly trackedFrames: number | null; // weak ones included
  readonly weakFrames: number | null;
  readonly tornFrames: number | null; // of which only a part arrived
  readonly positionSigma_m: number | null; // of the last frame that was tracked
  readonly rotationSigma_deg: number | null;
  readonly expectedPathError_m: number | null; // RMS over all frames
  readonly calibrationDoubt: string; // empty when the camera fits its images
  readonly cameraCorrection: string; // empty when the calibration is used as it was given
  readonly mapping: Readonly<Record<string, number>>; // counts of the map, by the server's names
  readonly up: MeasuredUp | null; // by the camera's accelerometer, if it has one
  readonly meanFrame_ms: number | null;
  readonly device: string;
}

export async function fetchReport(scanId: string, token: string): Promise<Report> {
  const response = await request(`${scanPath(scanId)}/report.json`, token, { limit_ms });
  return parseReport(await response.json());
}

function measuredUpOf(json: unknown): MeasuredUp | null {
  const up = isRecord(json) ? json : {};
  const axes = Array.isArray(up['in_world']) ? up['in_world'].map(numberOf) : [];
  const [x, y, z] = axes;
  const sigma_deg = numberOf(up['sigma_deg']);
  const areNumbers = axes.length === 3 && x != null && y != null && z != null;
  if (!areNumbers || sigma_deg === null || Math.abs(Math.hypot(x, y, z) - 1) > 1e-3) return null;
  return { inWorld: [x, y, z], sigma_rad: (sigma_deg * Math.PI) / 180 };
}

export function parseReport(json: unknown): Report {
  const report = isRecord(json) ? json : {};
  const mapping = isRecord(report['mapping']) ? Object.entries(report['mapping']) : [];
  const expected = isRecord(report['expected_error']) ? report['expected_error'] : {};
  return {
    surfels: numberOf(report['surfels']),
    cloudPoints: numberOf(report['cloud_points']),
    frames: numberOf(report['frames']),
    trackedFrames: numberOf(report['tracked_frames']),
    weakFrames: numberOf(report['weak_frames']),
    tornFrames: numberOf(report['torn_frames']),
    positionSigma_m: numberOf(report['position_sigma_m']),
    rotationSigma_deg: numberOf(report['rotation_sigma_deg']),
    expectedPathError_m: numberOf(expected['path_m']),
    calibrationDoubt: textOf(report['calibration_doubt']),
    cameraCorrection: textOf(report['camera_correction']),
    mapping: Object.fromEntries(
      mapping.filter((entry): entry is [string, number] => numberOf(entry[1]) !== null),
    ),
    up: measuredUpOf(report['up']),
    meanFrame_ms: numberOf(report['mean_frame_ms']),
    device: textOf(report['device']),
  };
}
