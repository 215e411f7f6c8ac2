// What has changed between two scans that have ended: asking for it, and its result.
import { t } from '../texts/texts';
import { ApiError, isRecord, numberOf, request, scanPath, textOf } from './api';
import type { CompareAnswer } from './compare_worker';
import type { ComparedPoints } from './compared_points';
import { exportStates, type ExportStateName } from './exports';

const limit_ms = 10_000;
const reportLimit_ms = 60_000;
const pointsLimit_ms = 30 * 60_000;

export const verdicts = [
  'same_place',
  'different_places',
  'ambiguous',
  'sliding',
  'mirrored',
  'too_sparse',
] as const;
export type Verdict = (typeof verdicts)[number];

export const regionKinds = ['added', 'removed', 'moved_towards', 'moved_away'] as const;
export type RegionKind = (typeof regionKinds)[number];

type Place = readonly [number, number, number];

// In the first scan's world.
export interface ChangedRegion {
  readonly kind: RegionKind;
  readonly area_m2: number;
  readonly distance_m: number; // signed, the mean; of moved ones
  readonly sigma_m: number;
  readonly low_m: Place;
  readonly high_m: Place;
}

export interface CompareReport {
  readonly verdict: Verdict;
  readonly agreeingShare: number; // of what both scans saw
  readonly overlap: number; // of the smaller scan
  // Of the registration, in its least certain direction; null without a registration.
  readonly weakestSigma_m: number | null;
  readonly leastChange_m: number;
  readonly comparedArea_m2: number;
  readonly unseenArea_m2: number;
  // The parts of the scans' maps: above 1 it is not known how they lie to each other.
  readonly partCounts: readonly [number, number];
  // Without the path of the second scan nothing is called removed, without that of
  // the first nothing added.
  readonly pathsKnown: readonly [boolean, boolean];
  readonly regions: readonly ChangedRegion[];
}

export interface ComparisonState {
  readonly state: ExportStateName;
  readonly done: number; // share, while it is made
  readonly words: string; // why it has failed, or still waits
  readonly report: CompareReport | null; // when ready
}

const pathOf = (first: string): string => `${scanPath(first)}/comparisons`;
const entryOf = (first: string, second: string): string =>
  `${pathOf(first)}/${encodeURIComponent(second)}`;

export async function fetchComparison(
  first: string,
  second: string,
  token: string,
  signal?: AbortSignal,
): Promise<ComparisonState> {
  const response = await request(entryOf(first, second), token, {
    limit_ms: reportLimit_ms,
    ...(signal ? { signal } : {}),
  });
  return parseComparison(await response.json());
}

export async function requestComparison(
  first: string,
  second: string,
  token: string,
): Promise<void> {
  const headers = { 'Content-Type': 'application/json' };
  await request(pathOf(first), token, {
    limit_ms,
    method: 'POST',
    headers,
    body: JSON.stringify({ with: second }),
  });
}

export async function removeComparison(
  first: string,
  second: string,
  token: string,
): Promise<void> {
  await request(entryOf(first, second), token, { limit_ms, method: 'DELETE' });
}

export async function fetchComparedPoints(
  first: string,
  second: string,
  token: string,
  signal: AbortSignal,
): Promise<ComparedPoints> {
  const response = await request(
    `${scanPath(first)}/compared-points/${encodeURIComponent(second)}`,
    token,
    {
      limit_ms: pointsLimit_ms,
      signal,
    },
  );
  const bytes = await response.arrayBuffer().catch(() => {
    throw new ApiError(t.theDownloadWasCutOff, false, true);
  });
  return readInWorker(bytes, signal);
}

function readInWorker(bytes: ArrayBuffer, signal: AbortSignal): Promise<ComparedPoints> {
  const worker = new Worker(new URL('./compare_worker.ts', import.meta.url), { type: 'module' });
  return new Promise<ComparedPoints>((resolve, reject) => {
    const failed = (): void => reject(new ApiError(t.theComparisonCannotBeShown, false));
    worker.onmessage = ({ data }: MessageEvent<CompareAnswer>) =>
      'points' in data ? resolve(data.points) : failed();
    worker.onerror = (event) => {
      event.preventDefault();
      failed();
    };
    signal.addEventListener('abort', failed);
    worker.postMessage(bytes, [bytes]);
  }).finally(() => worker.terminate());
}

export function parseComparison(json: unknown): ComparisonState {
  if (!isRecord(json)) throw new ApiError(t.theServersAnswerCannotBeRead, false);
  const state = exportStates.find((name) => name === json['state']);
  if (!state) throw new ApiError(t.theServersAnswerCannotBeRead, false);
  const report = state === 'ready' ? reportOf(json['report']) : null;
  return {
    state,
    done: Math.min(1, Math.max(0, numberOf(json['done']) ?? 0)),
    words: textOf(json['words']),
    report,
  };
}

function reportOf(json: unknown): CompareReport {
  const verdict = isRecord(json) ? verdicts.find((name) => name === json['verdict']) : undefined;
  if (!isRecord(json) || !verdict) throw new ApiError(t.theServersAnswerCannotBeRead, false);
  const rows = Array.isArray(json['regions']) ? json['regions'] : [];
  return {
    verdict,
    agreeingShare: numberOf(json['agreeing_share']) ?? 0,
    overlap: numberOf(json['overlap']) ?? 0,
    weakestSigma_m: numberOf(json['weakest_sigma_m']),
    leastChange_m: numberOf(json['least_change_m']) ?? 0,
    comparedArea_m2: numberOf(json['compared_area_m2']) ?? 0,
    unseenArea_m2: numberOf(json['unseen_area_m2']) ?? 0,
    partCounts: [numberOf(json['parts_of_a']) ?? 1, numberOf(json['parts_of_b']) ?? 1],
    pathsKnown: [json['path_of_a_is_known'] === true, json['path_of_b_is_known'] === true],
    regions: rows.filter(isRecord).map(regionOf),
  };
}

function regionOf(row: Record<string, unknown>): ChangedRegion {
  const kind = regionKinds.find((name) => name === row['kind']);
  const [low_m, high_m] = [placeOf(row['low_m']), placeOf(row['high_m'])];
  if (!kind || !low_m || !high_m) throw new ApiError(t.theServersAnswerCannotBeRead, false);
  return {
    kind,
    area_m2: numberOf(row['area_m2']) ?? 0,
    distance_m: numberOf(row['mean_distance_m']) ?? 0,
    sigma_m: numberOf(row['sigma_m']) ?? 0,
    low_m,
    high_m,
  };
}

function placeOf(value: unknown): Place | null {
  if (!Array.isArray(value) || value.length !== 3) return null;
  return value.every((one) => numberOf(one) !== null) ? (value as unknown as Place) : null;
}
