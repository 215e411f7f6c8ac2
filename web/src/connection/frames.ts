// What the camera of a scan that has ended has sent: the list of its frames, the images
// of one, and where it was.
import { t } from '../texts/texts';
import { ApiError, isRecord, numberOf, request, scanPath } from './api';
import type { Pose } from './events';

const list_ms = 60_000; // the server looks at each of hundreds of thousands
const image_ms = 15_000;

const statuses = ['unknown', 'tracked', 'weak', 'lost', 'left_out', 'refused', 'damaged'] as const;
export type FrameStatus = (typeof statuses)[number];

// By the number of the frame, from 0.
export interface FrameList {
  readonly timestamps_s: readonly (number | null)[]; // null: there is no image
  readonly statuses: readonly FrameStatus[];
  // Why it was weak or lost, in the server's words; older servers have kept none, which is empty.
  readonly reasons: readonly string[];
}

export interface DepthRange {
  readonly from_mm: number;
  readonly to_mm: number;
}

export interface DepthImage {
  readonly image: Blob;
  readonly shown: DepthRange; // what its colours span
  readonly measured: DepthRange; // in this frame
  readonly valid_percent: number | null; // of the pixels that have depth
}

export async function fetchFrames(
  scanId: string,
  token: string,
  signal: AbortSignal,
): Promise<FrameList> {
  const response = await request(`${scanPath(scanId)}/frames`, token, {
    limit_ms: list_ms,
    signal,
  });
  return parseFrames(await response.json());
}

export async function fetchColor(
  scanId: string,
  token: string,
  frame: number,
  signal: AbortSignal,
): Promise<Blob> {
  const response = await request(`${scanPath(scanId)}/frames/color/${frame}`, token, {
    limit_ms: image_ms,
    signal,
  });
  return response.blob();
}

// How far the viewers of a running scan are behind, by the server's clock, told with a
// colour image; null: not told.
export interface ServerDelays {
  readonly frameAge_ms: number | null; // since that frame arrived, when the answer was made
  readonly points_ms: number | null; // from the arrival of a frame to the points that show it first
  readonly surface_ms: number | null; // the same of the surface
}

// The same while the scan runs.
export interface LiveColor extends ServerDelays {
  readonly image: Blob;
  readonly answered_ms: number; // when the beginning of the answer was here
}

// Null: it is not on the server's disk yet.
export async function fetchLiveColor(
  scanId: string,
  token: string,
  frame: number,
  signal: AbortSignal,
): Promise<LiveColor | null> {
  const response = await request(`${scanPath(scanId)}/frames/color/${frame}`, token, {
    limit_ms: image_ms,
    signal,
  });
  const answered_ms = performance.now();
  if (response.status === 204) return null;
  const delay = (name: string): number | null => delayOf(response.headers.get(name));
  const delays = {
    frameAge_ms: delay('Frame-Age-Ms'),
    points_ms: delay('Points-Delay-Ms'),
    surface_ms: delay('Surface-Delay-Ms'),
  };
  return { image: await response.blob(), answered_ms, ...delays };
}

// Null: none, or no number of milliseconds.
export function delayOf(header: string | null): number | null {
  return /^\d{1,9}$/.test(header ?? '') ? Number(header) : null;
}

// `range`: what its colours are to span; null: what was measured in this frame.
export async function fetchDepth(
  scanId: string,
  token: string,
  frame: number,
  range: DepthRange | null,
  signal: AbortSignal,
): Promise<DepthImage> {
  const query = range ? `?from_mm=${range.from_mm}&to_mm=${range.to_mm}` : '';
  const response = await request(`${scanPath(scanId)}/frames/depth/${frame}${query}`, token, {
    limit_ms: image_ms,
    signal,
  });
  const shown = parseRange(response.headers.get('Depth-Shown-Mm'));
  const measured = parseRange(response.headers.get('Depth-Measured-Mm'));
  const percent = response.headers.get('Depth-Valid-Percent');
  return {
    image: await response.blob(),
    shown,
    measured,
    valid_percent: percent === null ? null : numberOf(Number(percent)),
  };
}

// trajectory.txt: a line for each frame that was used.
export async function fetchPath(
  scanId: string,
  token: string,
  signal: AbortSignal,
): Promise<string> {
  const response = await request(`${scanPath(scanId)}/trajectory.txt`, token, {
    limit_ms: list_ms,
    signal,
  });
  return response.text();
}

export function parseFrames(json: unknown): FrameList {
  const times =
    isRecord(json) && Array.isArray(json['timestamps_s'])
      ? json['timestamps_s'].map(numberOf)
      : null;
  const runs =
    isRecord(json) && Array.isArray(json['statuses']) ? json['statuses'].filter(isRecord) : null;
  if (!times || !runs) throw new ApiError(t.theServersListOfFramesCannot, false);
  const known: FrameStatus[] = [];
  for (const run of runs) {
    const status = statuses.find((name) => name === run['status']) ?? 'unknown';
    const count = Math.min(numberOf(run['frames']) ?? 0, times.length - known.length);
    for (let i = 0; i < count; ++i) known.push(status);
  }
  while (known.length < times.length) known.push('unknown');
  return { timestamps_s: times, statuses: known, reasons: reasonsIn(json, times.length) };
}

function reasonsIn(json: unknown, frames: number): string[] {
  const reasons = new Array<string>(frames).fill('');
  const told =
    isRecord(json) && Array.isArray(json['reasons']) ? json['reasons'].filter(isRecord) : [];
  for (const { reason, first, frames: counts } of told) {
    if (typeof reason !== 'string' || !Array.isArray(first) || !Array.isArray(counts)) continue;
    first.map(numberOf).forEach((from, i) => {
      const count = numberOf(counts[i]) ?? 0;
      if (from !== null && from >= 0 && count > 0) reasons.fill(reason, from, from + count);
    });
  }
  return reasons;
}

export function parseRange(header: string | null): DepthRange {
  const [, from, to] = /^(\d+)-(\d+)$/.exec(header ?? '') ?? [];
  return { from_mm: Number(from ?? 0), to_mm: Number(to ?? 0) };
}

// Where the camera was in each of these frames, by their times; null: nobody knows. `path` is in
// TUM's format, in the same order.
export function posesOf(path: string, timestamps_s: readonly (number | null)[]): (Pose | null)[] {
  const same_s = 1e-6; // the file has so many digits
  const lines = path.split('\n').filter((line) => line !== '' && !line.startsWith('#'));
  const timeOf = (line: string): number => Number(line.slice(0, line.indexOf(' ')));
  let next = 0;
  return timestamps_s.map((time_s) => {
    if (time_s === null) return null;
    while (next < lines.length && timeOf(lines[next]!) < time_s - same_s) ++next;
    if (next === lines.length || timeOf(lines[next]!) > time_s + same_s) return null;
    const [, tx, ty, tz, qx, qy, qz, qw] = lines[next++]!.split(' ').map(Number) as [
      number,
      number,
      number,
      number,
      number,
      number,
      number,
      number,
    ];
    return [tx, ty, tz, qx, qy, qz, qw].every(Number.isFinite)
      ? { translation: [tx, ty, tz], rotation: [qx, qy, qz, qw] }
      : null;
  });
}
