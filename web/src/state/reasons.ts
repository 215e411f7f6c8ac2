// Why the camera was lost or doubtful is told while a scan runs, and the server does not keep it: this page remembers what it has seen until it is closed.
import type { ScanEvent } from '../connection/events';

const most_reasons = 20_000; // of a scan: frames in ten minutes

const kept = new Map<string, Map<number, string>>(); // by scan and frame

export function keepReason(scanId: string, event: ScanEvent): void {
  if (event.kind !== 'frame' || event.tracking === 'tracked' || event.reason === '') return;
  const reasons = kept.get(scanId) ?? new Map<number, string>();
  if (reasons.size < most_reasons) reasons.set(event.sequence, event.reason);
  kept.set(scanId, reasons);
}

// The one that was told most often of these frames, empty when none was seen.
export function reasonOf(scanId: string, first: number, last: number): string {
  const times = new Map<string, number>();
  for (const [frame, reason] of kept.get(scanId) ?? [])
    if (frame >= first && frame <= last) times.set(reason, (times.get(reason) ?? 0) + 1);
  return [...times].sort((a, b) => b[1] - a[1])[0]?.[0] ?? '';
}
