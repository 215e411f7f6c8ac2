// The page of a comparison: asks the server for it, waits, and shows both scans with what
// has changed between them.
import { ApiError, errorText, fetchScan } from '../connection/api';
import {
  fetchComparedPoints,
  fetchComparison,
  removeComparison,
  requestComparison,
  type ComparisonState,
} from '../connection/comparisons';
import { patiently } from '../connection/patience';
import { fetchAccess, fetchReport } from '../connection/scans';
import { t } from '../texts/texts';
import { compareParts, type CompareParts } from './compare_parts';
import { CompareView, type ComparedModel } from './compare_view';
import { showHelp } from './dialogs';
import { setText, type Panel } from './dom';

const pollEvery_ms = 1_000;
const lookAgainEvery_ms = 15_000; // whether both scans are still there

export interface ComparePage extends Panel {
  drawCalls(): number;
  isResting(): boolean;
}

export function comparePage(first: string, second: string, token: string): ComparePage {
  const ended = new AbortController();
  const parts = compareParts(first);
  const shown = new CompareView(parts);
  const fetchModel = async (): Promise<ComparedModel | null> => {
    const [points, measuredUp] = await Promise.all([
      patiently(() => fetchComparedPoints(first, second, token, ended.signal), ended.signal),
      // A model that was made elsewhere has no report.
      fetchReport(first, token).then(
        ({ up }) => up,
        () => null,
      ),
    ]);
    return ended.signal.aborted ? null : { points, measuredUp };
  };
  const run = (again: boolean): void => {
    parts.ready(false);
    untilReady({ first, second, token, signal: ended.signal, again, parts })
      .then((state) => state && shown.show(state, fetchModel))
      .catch(
        (error: unknown) =>
          !ended.signal.aborted && parts.fail(errorText(error, t.theComparisonCannotBeShown)),
      );
  };
  parts.retry.addEventListener('click', () => run(true));
  parts.cancel.addEventListener(
    'click',
    () =>
      void removeComparison(first, second, token).catch((error: unknown) =>
        parts.fail(errorText(error)),
      ),
  );
  void showTitles(parts, [first, second], token);
  const stopLooking = watchDeletion(
    parts,
    () => fetchComparison(first, second, token, ended.signal),
    () => shown.isComplete,
  );
  const onKey = (event: KeyboardEvent): void => {
    const typing = event.target instanceof HTMLInputElement && event.target.type !== 'radio';
    if (
      typing ||
      document.querySelector('dialog') ||
      event.ctrlKey ||
      event.metaKey ||
      event.altKey
    )
      return;
    if (event.key === 'f') shown.frameAll();
    if (event.key === 'b') shown.swapLook();
    if (event.key === '?') showHelp();
  };
  document.addEventListener('keydown', onKey);
  run(false);
  return {
    element: parts.node,
    drawCalls: () => shown.scene?.drawCalls ?? 0,
    isResting: () => shown.scene?.isResting ?? true,
    dispose() {
      ended.abort();
      stopLooking();
      document.removeEventListener('keydown', onKey);
      shown.scene?.dispose();
    },
  };
}

async function showTitles(
  { names, title }: CompareParts,
  ids: readonly string[],
  token: string,
): Promise<void> {
  const scans = await Promise.all(ids.map((id) => fetchScan(id, token).catch(() => null)));
  scans.forEach((scan, i) => {
    names[i as 0 | 1].textContent = scan?.title ?? '';
  });
  const [a, b] = scans;
  if (!a || !b) return;
  setText(title, t.comparedTitles(a.title, b.title));
  document.title = `${t.comparedTitles(a.title, b.title)} – Hermite`;
}

interface Waiting {
  readonly first: string;
  readonly second: string;
  readonly token: string;
  readonly signal: AbortSignal;
  readonly again: boolean; // one that has failed is tried again
  readonly parts: CompareParts;
}

// Null: somebody has stopped it, or it has failed; the page says so.
async function untilReady({
  first,
  second,
  token,
  signal,
  again,
  parts,
}: Waiting): Promise<ComparisonState | null> {
  parts.wait(t.loadingTheComparison, null, false);
  const { view, scan: mayAsk, shared } = await patiently(() => fetchAccess(token), signal);
  if (shared || !view) throw new ApiError(t.aShareLinkShowsOneScan, true);
  let asked = false;
  for (;;) {
    const state = await patiently(() => fetchComparison(first, second, token, signal), signal);
    if (signal.aborted) return null;
    if (state.state === 'ready') return state;
    if (state.state === 'queued')
      parts.wait(state.words || t.theComparisonWaitsForItsTurn, null, mayAsk);
    if (state.state === 'running') parts.wait(t.bothScansAreBeingCompared, state.done, mayAsk);
    const isNew = state.state === 'missing' || (state.state === 'failed' && again);
    if (isNew && asked && state.state === 'missing') {
      parts.fail(t.theComparisonWasCancelled);
      return null;
    }
    if (state.state === 'failed' && (asked || !again)) {
      parts.fail(t.theyCouldNotBeCompared(state.words));
      return null;
    }
    if (isNew) {
      if (!mayAsk) throw new ApiError(t.nobodyHasComparedTheseScansYet, true);
      await patiently(() => requestComparison(first, second, token), signal);
      asked = true;
    }
    await new Promise((resolve) => setTimeout(resolve, isNew ? 0 : pollEvery_ms));
    if (signal.aborted) return null;
  }
}

// Says when one of both is deleted while somebody looks.
function watchDeletion(
  { notice }: CompareParts,
  ask: () => Promise<unknown>,
  isShown: () => boolean,
): () => void {
  const look = (): void => {
    if (!isShown() || document.hidden) return;
    ask().catch((error: unknown) => {
      if (!(error instanceof ApiError && error.missing)) return;
      setText(notice, t.oneOfBothScansHasBeen);
      notice.hidden = false;
    });
  };
  const timer = setInterval(look, lookAgainEvery_ms);
  document.addEventListener('visibilitychange', look);
  return () => {
    clearInterval(timer);
    document.removeEventListener('visibilitychange', look);
  };
}
