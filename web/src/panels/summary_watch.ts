// Asks what the list says of the scan that is looked at, which its connection does not tell.
import { fetchScan } from '../connection/api';
import { patiently } from '../connection/patience';
import type { LiveScan, LiveScanEvent } from '../state/live_scan';
import type { Store } from '../state/store';

// Once, as soon as the server has said that there is such a scan. Returns how to stop.
export function watchSummary(scan: Store<LiveScan, LiveScanEvent>, token: string): () => void {
  const stopped = new AbortController();
  const load = async (scanId: string): Promise<void> => {
    const summary = await patiently(() => fetchScan(scanId, token), stopped.signal);
    if (!stopped.signal.aborted) scan.dispatch({ kind: 'listed', as: summary });
  };
  let asked = false;
  const unsubscribe = scan.subscribe(({ scanId, connection }) => {
    if (asked || connection !== 'open') return;
    asked = true;
    load(scanId).catch(() => {}); // the scan can be looked at without it
  });
  return () => {
    stopped.abort();
    unsubscribe();
  };
}
