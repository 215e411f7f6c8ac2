// The jobs that the server makes of recordings. How these get there: upload.ts.
import { t } from '../texts/texts';
import { ApiError, isRecord, numberOf, request, textOf } from './api';

const limit_ms = 10_000;

export type JobState = 'queued' | 'running' | 'finished' | 'failed' | 'cancelled' | 'unknown';

export interface Job {
  readonly id: string;
  readonly title: string;
  readonly state: JobState;
  readonly stage: string; // what a running one is at, or empty
  readonly done: number;
  readonly total: number; // 0: not known
  readonly words: string; // why it failed, or empty
  readonly scanId: string | null;
}

// Newest first. A token that only looks knows of none.
export async function fetchJobs(token: string): Promise<Job[]> {
  try {
    const response = await request('api/v1/jobs', token, { limit_ms });
    return parseJobs(await response.json());
  } catch (error) {
    if (error instanceof ApiError && error.unauthorized) return [];
    throw error;
  }
}

export async function cancelJob(id: string, token: string): Promise<void> {
  await request(`api/v1/jobs/${encodeURIComponent(id)}`, token, { limit_ms, method: 'DELETE' });
}

export async function retryJob(id: string, token: string): Promise<void> {
  await request(`api/v1/jobs/${encodeURIComponent(id)}/retry`, token, { limit_ms, method: 'POST' });
}

// Rows that are not jobs are left out.
export function parseJobs(json: unknown): Job[] {
  const rows = isRecord(json) && Array.isArray(json['jobs']) ? json['jobs'] : null;
  if (!rows) throw new ApiError(t.theServersListOfJobsCannot, false);
  return rows
    .filter(isRecord)
    .filter((row) => typeof row['id'] === 'string')
    .map(jobOf);
}

function jobOf(row: Record<string, unknown>): Job {
  return {
    id: String(row['id']),
    title: textOf(row['title']) || t.untitledRecording,
    state: stateOf(row['state']),
    stage: textOf(row['stage']),
    done: numberOf(row['done']) ?? 0,
    total: numberOf(row['total']) ?? 0,
    words: textOf(row['words']),
    scanId: textOf(row['scan']) || null,
  };
}

function stateOf(value: unknown): JobState {
  return value === 'queued' ||
    value === 'running' ||
    value === 'finished' ||
    value === 'failed' ||
    value === 'cancelled'
    ? value
    : 'unknown';
}
