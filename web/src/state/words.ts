// States and quantities in the words that a person reads. One word per thing: scan, frame, submap, point.
import type { LiveScan } from './live_scan';

export type Tone = 'good' | 'busy' | 'warn' | 'bad' | 'quiet';

export interface Words {
  readonly text: string;
  readonly tone: Tone;
}

export function phaseWords(phase: string): Words {
  switch (phase) {
    case 'running':
      return { text: 'Scanning', tone: 'good' };
    case 'finished':
      return { text: 'Finished', tone: 'quiet' };
    case 'failed':
      return { text: 'Failed', tone: 'bad' };
    case 'interrupted':
      return { text: 'Interrupted', tone: 'warn' };
    default:
      return { text: 'Unknown', tone: 'quiet' };
  }
}

export function trackingWords(scan: LiveScan): Words {
  if (scan.tracking === 'none') return { text: scan.phase === 'running' ? 'Waiting for the first frame' : 'No frame yet', tone: 'quiet' };
  if (scan.tracking === 'tracked') return { text: 'Tracking', tone: 'good' };
  const word = scan.tracking === 'weak' ? 'Weak' : 'Lost';
  return { text: scan.trackingReason ? `${word}: ${scan.trackingReason}` : word, tone: 'warn' };
}

export function connectionWords(scan: LiveScan): Words {
  switch (scan.connection) {
    case 'connecting':
      return { text: 'Connecting', tone: 'busy' };
    case 'open':
      return scan.snapshotComplete ? { text: 'Connected', tone: 'good' } : { text: 'Loading', tone: 'busy' };
    case 'waiting':
      return { text: `Reconnecting in ${seconds(scan.retryIn_ms)}`, tone: 'warn' };
    case 'closed':
      return scan.problem ? { text: 'Closed', tone: 'bad' } : { text: 'Complete', tone: 'quiet' };
  }
}

// What stands in the middle of an otherwise empty picture, null when there is something to see.
export function emptyWords(scan: LiveScan): string | null {
  if (scan.points > 0) return null;
  if (scan.problem?.code === 'not_found') return 'This scan does not exist, or no longer.';
  if (scan.problem?.code === 'unauthorized') return 'The server does not accept this access token.';
  if (scan.problem) return scan.problem.message;
  if (scan.connection === 'waiting') return 'The server cannot be reached. Trying again.';
  if (scan.connection === 'connecting' || !scan.snapshotComplete) return 'Loading the scan.';
  if (scan.phase === 'running') return 'The first points appear as soon as a surface has been seen often enough.';
  return 'This scan has no points.';
}

export function count(value: number): string {
  return value.toLocaleString('en-GB');
}

export function seconds(duration_ms: number): string {
  return duration_ms < 1000 ? 'less than a second' : `${Math.round(duration_ms / 1000)} s`;
}

export function ago(then: Date, now: Date): string {
  const minutes = Math.floor((now.getTime() - then.getTime()) / 60_000);
  if (minutes < 1) return 'just now';
  if (minutes < 60) return minutes === 1 ? 'a minute ago' : `${minutes} minutes ago`;
  const hours = Math.floor(minutes / 60);
  if (hours < 24) return hours === 1 ? 'an hour ago' : `${hours} hours ago`;
  return then.toLocaleDateString('en-GB', { day: 'numeric', month: 'long', year: 'numeric' });
}
