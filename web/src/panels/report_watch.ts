// Asks for the report of a scan once it has ended, so that the page can say how well
// the camera was followed.
import { fetchFrames } from '../connection/frames';
import { patiently } from '../connection/patience';
import { fetchAccess, fetchReport } from '../connection/scans';
import type { LiveScan, LiveScanEvent } from '../state/live_scan';
import { followedOf } from '../state/quality_text';
import type { Store } from '../state/store';

// Once, when there is one. The list of frames is asked for where there is more to say
// than that all were followed.
export function watchReport(scan: Store<LiveScan, LiveScanEvent>, token: string): () => void {
  const stopped = new AbortController();
  const load = async (scanId: string): Promise<void> => {
    const report = await patiently(() => fetchReport(scanId, token), stopped.signal);
    scan.dispatch({ kind: 'report', report });
    scan.dispatch({ kind: 'followed', followed: followedOf(report, null) });
    const { view, shared } = await patiently(() => fetchAccess(token), stopped.signal);
    const isPlain =
      report.weakFrames === 0 &&
      report.trackedFrames === report.frames &&
      scan.get().framesDropped === 0;
    if (isPlain || !view || shared) return;
    scan.dispatch({
      kind: 'followed',
      followed: followedOf(
        report,
        await patiently(() => fetchFrames(scanId, token, stopped.signal), stopped.signal),
      ),
    });
  };
  let asked = false;
  const unsubscribe = scan.subscribe((state) => {
    const ended =
      state.connection === 'closed' &&
      (state.phase === 'finished' || state.phase === 'interrupted');
    if (asked || !ended || state.framesProcessed === 0) return;
    asked = true;
    load(state.scanId).catch(() => {}); // what has come by then is said
  });
  return () => {
    stopped.abort();
    unsubscribe();
  };
}
