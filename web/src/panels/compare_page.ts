// The page of a comparison: asks the server for it, waits, and shows both scans with what has changed between them.
import { ApiError, errorText, fetchScan } from '../connection/api';
import type { ComparedPoints } from '../connection/compared_points';
import { fetchComparedPoints, fetchComparison, removeComparison, requestComparison, type ComparisonState } from '../connection/comparisons';
import { patiently } from '../connection/patience';
import { fetchAccess } from '../connection/scans';
import { CompareScene } from '../scene/compare_scene';
import { looks, type Look } from '../state/comparing';
import { hashOf } from '../state/route';
import { t } from '../texts/texts';
import { comparePanel } from './compare_panel';
import { showHelp } from './dialogs';
import { element, setText, type Panel } from './dom';
import { segments } from './segments';

const pollEvery_ms = 1_000;
const lookAgainEvery_ms = 15_000; // whether both scans are still there

export interface ComparePage extends Panel {
  drawCalls(): number;
  isResting(): boolean;
}

export function comparePage(first: string, second: string, token: string): ComparePage {
  const ended = new AbortController();
  const parts = partsOf(first);
  let scene: CompareScene | null = null;
  let points: ComparedPoints | null = null;
  let look: Look = 'overlay';
  const told = panelOf();
  function panelOf() {
    let regions: ComparisonState['report'] = null;
    const panel = comparePanel((index) => {
      const region = regions?.regions[index];
      if (!region || !scene) return;
      panel.choose(index);
      scene.flyTo(region, points?.regions.get(index));
    });
    return { panel, keep: (report: ComparisonState['report']) => (regions = report) };
  }
  const choice = segments('compare-look', t.howBothAreShown, looks, { overlay: t.oneOverTheOther, sides: t.sideBySide }, (chosen) =>
    setLook(chosen),
  );
  choice.element.hidden = true;
  parts.bar.append(choice.element);
  parts.node.append(told.panel.element);
  const setLook = (chosen: Look): void => {
    look = chosen;
    choice.check(look);
    parts.node.classList.toggle('sides', look === 'sides');
    told.panel.showLook(look);
    scene?.setLook(look);
  };
  const frameAll = (): void => {
    told.panel.choose(null);
    scene?.frameAll();
  };
  const showPoints = async (): Promise<void> => {
    parts.say(t.loadingTheComparison);
    points = await patiently(() => fetchComparedPoints(first, second, token, ended.signal), ended.signal);
    if (ended.signal.aborted) return;
    try {
      scene = new CompareScene(parts.canvas);
    } catch {
      parts.say(t.thisBrowserCannotShow3dPictures); // the list of changes is there
      return;
    }
    scene.show(points.chunks, look);
    choice.element.hidden = parts.all.hidden = false;
    setLook(look);
    parts.say('');
  };
  const showReport = async ({ report }: ComparisonState): Promise<void> => {
    if (!report) return;
    told.keep(report);
    told.panel.show(report);
    if (report.verdict === 'same_place') await showPoints();
    else parts.say(t.thereIsNoPictureOfBoth);
  };
  const run = (again: boolean): void => {
    parts.ready(false);
    untilReady({ first, second, token, signal: ended.signal, again, parts })
      .then((state) => state && showReport(state))
      .catch((error: unknown) => !ended.signal.aborted && parts.fail(errorText(error, t.theComparisonCannotBeShown)));
  };
  parts.retry.addEventListener('click', () => run(true));
  parts.all.addEventListener('click', frameAll);
  parts.cancel.addEventListener(
    'click',
    () => void removeComparison(first, second, token).catch((error: unknown) => parts.fail(errorText(error))),
  );
  void showTitles(parts, [first, second], token);
  const stopLooking = watchDeletion(
    parts,
    () => fetchComparison(first, second, token, ended.signal),
    () => points !== null,
  );
  const onKey = (event: KeyboardEvent): void => {
    const typing = event.target instanceof HTMLInputElement && event.target.type !== 'radio';
    if (typing || document.querySelector('dialog') || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === 'f') frameAll();
    if (event.key === 'b' && scene) setLook(look === 'overlay' ? 'sides' : 'overlay');
    if (event.key === '?') showHelp();
  };
  document.addEventListener('keydown', onKey);
  run(false);
  return {
    element: parts.node,
    drawCalls: () => scene?.drawCalls ?? 0,
    isResting: () => scene?.isResting ?? true,
    dispose() {
      ended.abort();
      stopLooking();
      document.removeEventListener('keydown', onKey);
      scene?.dispose();
    },
  };
}

type Parts = ReturnType<typeof partsOf>;

function partsOf(first: string) {
  const canvas = element('canvas', { class: 'picture', tabindex: 0, 'aria-label': t.bothScansInThreeDimensionsArrow });
  const names = [element('h2', { class: 'compare-name' }), element('h2', { class: 'compare-name' })] as const;
  const message = element('p', { class: 'compare-words', role: 'status' });
  const progress = element('progress', { class: 'facts', max: 1, 'aria-label': t.progressOfTheComparison });
  const cancel = element('button', { type: 'button', class: 'button' }, t.cancel);
  const retry = element('button', { type: 'button', class: 'button primary' }, t.tryAgain);
  const middle = element('div', { class: 'compare-middle' }, message, progress, element('div', { class: 'buttons' }, cancel, retry));
  const notice = element('p', { class: 'compare-notice', role: 'status' });
  const all = element('button', { type: 'button', class: 'button compare-all', title: t.showsTheWholeScanF }, t.showAll);
  const stage = element('div', { class: 'compare-stage' }, canvas, ...names, middle, notice, all);
  const back = element(
    'a',
    { class: 'back', href: hashOf(first), 'aria-label': t.backToTheScan },
    element('span', { 'aria-hidden': 'true' }, '←'),
  );
  const title = element('h1', {}, t.comparison);
  const bar = element('header', { class: 'compare-head' }, back, title);
  const node = element('main', { class: 'compare-page' }, bar, stage);
  const ready = (mayTry: boolean): void => {
    progress.hidden = cancel.hidden = true;
    retry.hidden = !mayTry;
  };
  const say = (text: string): void => {
    setText(message, text);
    ready(false);
    middle.hidden = text === '';
  };
  notice.hidden = all.hidden = true;
  ready(false);
  return {
    node,
    bar,
    canvas,
    names,
    title,
    progress,
    cancel,
    retry,
    notice,
    all,
    ready,
    say,
    fail(text: string) {
      say(text);
      retry.hidden = false;
    },
    wait(text: string, done: number | null, mayCancel: boolean) {
      say(text);
      progress.hidden = false;
      if (done === null) progress.removeAttribute('value');
      else progress.value = done;
      cancel.hidden = !mayCancel;
    },
  };
}

async function showTitles({ names, title }: Parts, ids: readonly string[], token: string): Promise<void> {
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
  readonly parts: Parts;
}

// Null: somebody has stopped it, or it has failed; the page says so.
async function untilReady({ first, second, token, signal, again, parts }: Waiting): Promise<ComparisonState | null> {
  parts.wait(t.loadingTheComparison, null, false);
  const { view, scan: mayAsk, shared } = await patiently(() => fetchAccess(token), signal);
  if (shared || !view) throw new ApiError(t.aShareLinkShowsOneScan, true);
  let asked = false;
  for (;;) {
    const state = await patiently(() => fetchComparison(first, second, token, signal), signal);
    if (signal.aborted) return null;
    if (state.state === 'ready') return state;
    if (state.state === 'queued') parts.wait(state.words || t.theComparisonWaitsForItsTurn, null, mayAsk);
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
function watchDeletion({ notice }: Parts, ask: () => Promise<unknown>, isShown: () => boolean): () => void {
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
