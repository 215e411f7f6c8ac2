// The quality of one scan as a page to print: what became of its frames, where the camera was lost,
// and images of the model. It says what the server and the model tell, and leaves out the rest.
import { ApiError, errorText, fetchScan, type ScanSummary } from '../connection/api';
import type { ScanEvent } from '../connection/events';
import { fetchFrames, fetchPath, type FrameList } from '../connection/frames';
import { ScanLink } from '../connection/link';
import { orMissing, patiently } from '../connection/patience';
import { fetchAccess, fetchReport, type Report } from '../connection/scans';
import { ModelImages, NoWebGl } from '../scene/model_images';
import { pathOf, type CameraPath } from '../state/camera_path';
import {
  hasEnded,
  initialLiveScan,
  reduceLiveScan,
  type LiveScan,
  type LiveScanEvent,
} from '../state/live_scan';
import { isMeshSettled, meshText } from '../state/mesh';
import { frameShares, mapFacts, scanFacts, statesUncertainty } from '../state/quality_facts';
import { followedOf, qualityText, type Followed } from '../state/quality_text';
import { receiver } from '../state/receiver';
import { frameHash, hashOf, qualityHash } from '../state/route';
import { createStore, type Store } from '../state/store';
import { storedUp } from '../state/up_choice';
import { emptyText, partsText, sentence, soFarText, trackingText } from '../state/text';
import { t } from '../texts/texts';
import { showHelp } from './dialogs';
import { buttonOf, element, setText, type Panel } from './dom';
import { watchMesh } from './mesh_watch';
import { qualityDoubts } from './quality_doubts';
import { factList, modelSection } from './quality_model';
import { qualityStrip } from './quality_strip';
import { shareButton } from './share_button';
import { ofThisBrowser } from '../state/storages';

const askEvery_ms = 10_000; // whether the scan is still there

type ScanStore = Store<LiveScan, LiveScanEvent>;

export interface QualityPage extends Panel {
  readonly scan: ScanStore;
}

export function qualityPage(scanId: string, token: string): QualityPage {
  const scan = createStore(initialLiveScan(scanId), reduceLiveScan);
  const ended = new AbortController();
  const parts = partsOf(scanId, token);
  const images = new ModelImages(storedUp(ofThisBrowser, scanId));
  const onEvent = (event: ScanEvent): void => images.onEvent(event);
  const link = new ScanLink({
    scanId,
    token,
    watch: { points: false, mesh: false },
    onEvent: receiver(scan.dispatch, onEvent),
  });
  const mesh = watchMesh({ scan, scene: images, token, isEdited: async () => false });
  const told = new ToldScan(scanId, token, ended.signal, parts);
  const draw = once(() => showModel(parts.model, images, scan.get().followed?.parts ?? 1));
  const watch = once(() => void told.watch(scan));
  let isLoaded = false;
  const load = once(() => {
    void told.load(scan).finally(() => {
      isLoaded = true;
      refresh(scan.get());
    });
  });
  const refresh = (state: LiveScan): void => {
    if (ended.signal.aborted) return;
    showState(parts, state, told.gone);
    if (state.phase !== 'unknown') watch(); // the server has it
    if (!isComplete(state)) return;
    load();
    const isSettled = isMeshSettled(state);
    if (isSettled && isLoaded) draw();
    else if (!isSettled)
      parts.model.replaceChildren(
        element(
          'p',
          { class: 'quality-note', role: 'status' },
          meshText(state.mesh, true) || t.loadingTheModel,
        ),
      );
  };
  const unsubscribe = scan.subscribe(refresh);
  const onKey = (event: KeyboardEvent): void => {
    if (
      event.target instanceof HTMLInputElement ||
      document.querySelector('dialog') ||
      event.ctrlKey ||
      event.metaKey ||
      event.altKey
    )
      return;
    if (event.key === 'q') location.hash = hashOf(scanId);
    if (event.key === '?') showHelp();
  };
  document.addEventListener('keydown', onKey);
  return {
    element: parts.node,
    scan,
    dispose() {
      ended.abort();
      document.removeEventListener('keydown', onKey);
      unsubscribe();
      mesh.dispose();
      link.close();
      images.dispose();
    },
  };
}

const isComplete = ({ connection, phase }: LiveScan): boolean =>
  connection === 'closed' && hasEnded(phase);

function once(act: () => void): () => void {
  let done = false;
  return () => {
    if (done) return;
    done = true;
    act();
  };
}

type Parts = ReturnType<typeof partsOf>;

function partsOf(scanId: string, token: string) {
  const title = element('h1', {}, t.qualityOfAScan);
  // The summary of a running scan changes all the time, so that it is not read aloud when it does.
  const summary = element('p', { class: 'lead' });
  const notice = element('p', { class: 'notice', role: 'status' });
  const problem = element('span', { class: 'problem', role: 'alert' });
  const share = shareButton(scanId, token, problem, () => qualityHash(scanId).split('?')[1]!);
  share.hidden = true;
  const print = buttonOf(t.print, { title: t.alsoAsAPdf });
  print.addEventListener('click', () => window.print());
  const back = element(
    'a',
    { class: 'back', href: hashOf(scanId) },
    element('span', { 'aria-hidden': 'true' }, '←'),
    ` ${t.backToTheModel}`,
  );
  const bar = element(
    'header',
    { class: 'quality-bar' },
    back,
    element('span', { class: 'space' }),
    problem,
    share,
    print,
  );
  const [facts, camera, doubts, model, map] = [
    element('div'),
    element('div'),
    element('div'),
    element('div'),
    element('div'),
  ];
  const sections = [
    sectionOf(t.theCamera, camera),
    sectionOf(t.whereItWasLostOrDoubtful, doubts),
    sectionOf(t.theModel, model),
    sectionOf(t.theMap, map),
  ];
  for (const section of sections) section.hidden = true;
  const node = element(
    'main',
    { class: 'quality-page' },
    bar,
    title,
    summary,
    notice,
    facts,
    ...sections,
  );
  return { node, title, summary, notice, share, print, facts, camera, doubts, model, map };
}

function sectionOf(name: string, content: HTMLElement): HTMLElement {
  return element('section', {}, element('h2', {}, name), content);
}

function fill(content: HTMLElement, ...children: Node[]): void {
  content.replaceChildren(...children);
  content.parentElement!.hidden = children.length === 0;
}

// What the connection says, at the top of the page.
function showState(
  { title, summary, notice, print, model }: Parts,
  state: LiveScan,
  gone: boolean,
): void {
  setText(title, state.title || t.qualityOfAScan);
  document.title = state.title ? t.qualityOf(state.title) : 'Hermite';
  setText(
    summary,
    [summaryText(state), sentence(state.phaseText)].filter((part) => part !== '').join(' '),
  );
  const known = state.phase !== 'unknown';
  print.hidden = !known || state.phase === 'running';
  const said = gone
    ? t.thisScanHasBeenDeleted
    : known
      ? runningText(state)
      : (emptyText(state) ?? '');
  setText(notice, said);
  notice.hidden = said === '';
  model.parentElement!.hidden = !isComplete(state);
}

function summaryText(state: LiveScan): string {
  const { phase, followed, framesReceived, tracking } = state;
  if (phase === 'finished' && framesReceived === 0) return t.thisModelWasImportedNoCamera;
  if (phase !== 'running') return followed ? qualityText(followed, state.phaseText) : '';
  const now =
    tracking === 'tracked' ? t.theCameraIsBeingFollowed : sentence(trackingText(state).text);
  return [now, soFarText(state), partsText(state)].filter((part) => part !== '').join(' ');
}

function runningText({ connection, phase }: LiveScan): string {
  if (connection === 'waiting') return t.theServerCannotBeReachedTrying;
  return phase === 'running' ? t.theScanIsRunningThisPage : '';
}

function showModel(node: HTMLElement, images: ModelImages, parts: number): void {
  try {
    const look = images.draw();
    fill(
      node,
      look
        ? modelSection(look, parts)
        : element('p', { class: 'quality-note' }, t.thereIsNoModelNothingWas),
    );
  } catch (error) {
    const isOld = error instanceof NoWebGl;
    if (!isOld) console.error(error); // a mistake of ours
    fill(
      node,
      element(
        'p',
        { class: 'quality-note' },
        isOld ? t.thisBrowserCannotShow3dPictures : t.thePicturesOfTheModelCould,
      ),
    );
  }
}

// What the server tells of the scan besides the model, each part by itself: what is
// missing is left out or said.
class ToldScan {
  gone = false;
  private summary: ScanSummary | null = null;
  private path: CameraPath | null = null;

  constructor(
    private readonly scanId: string,
    private readonly token: string,
    private readonly signal: AbortSignal,
    private readonly parts: Parts,
  ) {}

  // Until the page is left, or the scan is gone.
  async watch(scan: ScanStore): Promise<void> {
    while (!this.signal.aborted && !this.gone) {
      try {
        if (document.visibilityState === 'visible')
          this.summary = await fetchScan(this.scanId, this.token);
        if (this.signal.aborted) return;
        this.showFacts();
      } catch (error) {
        if (this.signal.aborted) return;
        this.gone = error instanceof ApiError && error.missing;
        if (this.gone) showState(this.parts, scan.get(), true);
      }
      await nextLook(this.signal);
    }
  }

  // Of a scan that has ended.
  async load(scan: ScanStore): Promise<void> {
    const { scanId, token, signal } = this;
    const access = await fetchAccess(token).catch(() => null);
    if (signal.aborted) return;
    this.parts.share.hidden = !(access?.view && access.scan);
    if (scan.get().framesReceived === 0) return; // imported
    const [told, list, path] = await Promise.all([
      orMissing(patiently(() => fetchReport(scanId, token), signal)).catch((error) =>
        errorText(error, t.itCannotBeRead),
      ),
      access?.shared
        ? 'shared'
        : patiently(() => fetchFrames(scanId, token, signal), signal).catch((error) =>
            errorText(error, t.theFramesCouldNotBeLoaded),
          ),
      patiently(() => fetchPath(scanId, token, signal), signal).catch(() => ''),
    ]);
    if (signal.aborted) return;
    this.path = pathOf(path);
    const report = typeof told === 'string' ? null : told;
    const followed = followedOf(
      report,
      typeof list === 'string' ? null : list,
      typeof told === 'string' ? told : '',
    );
    if (report) scan.dispatch({ kind: 'report', report });
    scan.dispatch({ kind: 'followed', followed });
    this.showFacts();
    this.showCamera(followed, list);
    if (report) this.showMap(report);
  }

  private showFacts(): void {
    if (this.summary)
      this.parts.facts.replaceChildren(factList(scanFacts(this.summary, this.path)));
  }

  private showCamera(followed: Followed, list: FrameList | string): void {
    const { scanId, token, signal } = this;
    const shares = frameShares(followed).map(({ kind, label, value }) =>
      element(
        'li',
        {},
        element('span', { class: `swatch swatch-${kind}`, 'aria-hidden': 'true' }),
        element('span', {}, label),
        element('span', { class: 'share-value' }, value),
      ),
    );
    const note = (text: string): HTMLElement => element('p', { class: 'quality-note' }, text);
    const legend = element('ul', { class: 'shares' }, ...shares);
    if (typeof list === 'string') {
      fill(this.parts.camera, legend, note(list === 'shared' ? t.thisLinkShowsTheModelAnd : list));
      return;
    }
    const strip =
      followed.stretches &&
      qualityStrip(list, followed.stretches, (frame) => (location.hash = frameHash(scanId, frame)));
    fill(
      this.parts.camera,
      ...(strip
        ? [
            strip,
            legend,
            element('p', { class: 'quality-note on-screen' }, t.aClickIntoTheStripOpens),
          ]
        : [legend, note(t.theListOfFramesDoesNot)]),
    );
    const { doubts } = followed;
    if (!doubts || doubts.length === 0) return;
    const isExplained = list.reasons.some((reason) => reason !== '');
    const why = isExplained ? t.theReasonOfAPlaceIs : t.whyTheCameraWasLostIs;
    fill(
      this.parts.doubts,
      qualityDoubts(doubts, { scanId, token, signal, list }),
      note(`${why} ${t.whatIsSaidOfAnImage}`),
    );
  }

  private showMap(report: Report): void {
    const sentences = [
      ...(report.expectedPathError_m === null ? [] : [t.thePathsErrorIsEstimated]),
      ...(statesUncertainty(report) ? [t.positionAndDirectionAtTheEnd] : []),
      t.nothingHereWasComparedWith,
    ];
    fill(
      this.parts.map,
      factList(mapFacts(report)),
      element('p', { class: 'quality-note' }, sentences.join(' ')),
    );
  }
}

// After a while, or when somebody comes back to the page.
function nextLook(signal: AbortSignal): Promise<void> {
  return new Promise((resolve) => {
    const done = (): void => {
      clearTimeout(timer);
      document.removeEventListener('visibilitychange', done);
      signal.removeEventListener('abort', done);
      resolve();
    };
    const timer = setTimeout(done, askEvery_ms);
    document.addEventListener('visibilitychange', done);
    signal.addEventListener('abort', done);
  });
}
