// The page of one scan: the image fills it, the panels float above. Wires the connection, the ledger, the state and the scene together.
import { errorText } from '../connection/api';
import type { ScanEvent, Watch } from '../connection/events';
import { ScanLink } from '../connection/link';
import { fetchFrames } from '../connection/frames';
import { patiently } from '../connection/patience';
import { fetchAccess, fetchReport, noAccess, pauseScan, stopScan, type Access } from '../connection/scans';
import { ScanScene } from '../scene/scene';
import { cutQuery, readCut } from '../state/cut_link';
import { isEmbedded } from '../state/embed';
import { reduceCutting, type Cutting, type CuttingEvent } from '../state/cutting';
import { initialLiveScan, reduceLiveScan, type LiveScan, type LiveScanEvent } from '../state/live_scan';
import { meshText } from '../state/mesh';
import { storedDraft } from '../state/note_drafts';
import { noteQuery, readNote } from '../state/note_link';
import { initialNoting, reduceNoting, type Noting, type NotingEvent } from '../state/noting';
import { followedOf } from '../state/quality_text';
import { receiver } from '../state/receiver';
import { frameOf, hashOf, qualityHash } from '../state/route';
import { createStore, type Store } from '../state/store';
import { storedUp, storeUp } from '../state/up_choice';
import { initialViewOptions, reduceViewOptions, storedShow, storeShow, watchOf, type ViewOptions } from '../state/view_options';
import { emptyText, phaseText } from '../state/text';
import { t } from '../texts/texts';
import { showHelp } from './dialogs';
import { showEmbedding } from './embed_dialog';
import { embeddedBar } from './embedded_bar';
import { element, setText, type Panel } from './dom';
import { downloadMenu } from './download_menu';
import { floorPicker, type FloorPicker } from './floor_picker';
import { chooseCompared } from './compare_chooser';
import { coverageLegend } from './coverage_legend';
import { watchEdits, type EditsWatch } from './edits_watch';
import { framesPanel, type FramesPanel } from './frames_panel';
import { chooseLanguage, otherLanguages } from './language_choice';
import { watchFreePart } from './free_watch';
import { livePanel, type LivePanel } from './live_panel';
import { statusMark } from './mark';
import { measurePanel, type MeasurePanel } from './measure_panel';
import { menu, type MenuItem } from './menu';
import { watchMesh } from './mesh_watch';
import { notesPanel, type NotesPanel } from './notes_panel';
import { deleteSoon, rename } from './scan_actions';
import { showFloorPlan } from './plan_dialog';
import { sectionPanel, type SectionPanel } from './section_panel';
import { shareButton } from './share_button';
import { statusPanel } from './status_panel';
import { viewPanel } from './view_panel';
import { ofThisBrowser, ofThisTab } from '../state/storages';

const addressAfter_ms = 400;

type ScanStore = Store<LiveScan, LiveScanEvent>;
type OptionsStore = Store<ViewOptions, Partial<ViewOptions>>;

export interface ScanPage extends Panel {
  drawCalls(): number; // of the newest image
  isResting(): boolean; // nothing moves in it
  readonly scan: ScanStore;
}

// `view`: how the address says that it is looked at.
export function scanPage(scanId: string, token: string, view: string): ScanPage {
  const scan = createStore(initialLiveScan(scanId), reduceLiveScan);
  const options: OptionsStore = createStore<ViewOptions, Partial<ViewOptions>>(
    { ...initialViewOptions, show: storedShow(ofThisBrowser) },
    reduceViewOptions,
  );
  const cutting = createStore<Cutting, CuttingEvent>(readCut(view), reduceCutting);
  const noting = createStore<Noting, NotingEvent>(
    { ...initialNoting, chosen: readNote(view), draft: storedDraft(ofThisTab, scanId) },
    reduceNoting,
  );
  const query = (): string => [cutQuery(cutting.get()), noteQuery(noting.get().chosen)].filter(Boolean).join('&');
  const canvas = element('canvas', { class: 'picture', tabindex: 0, 'aria-label': t.theScanInThreeDimensionsArrow });
  const stage = element('div', { class: 'stage' }, canvas);
  const empty = element('p', { class: 'empty', role: 'status' });
  const scene = openScene(canvas, () => options.dispatch({ follow: false }));
  const note = element('p', { class: 'mesh-note', role: 'status' });
  const floor = scene && floorPicker(canvas, (x_px, y_px) => setFloor(scene, scanId, x_px, y_px));
  scene?.setUp(storedUp(ofThisBrowser, scanId));
  const embedded = isEmbedded(view);
  const viewing: Viewing = {
    actions: () => (scene && floor && tools ? viewActions({ scanId, scene, floor, options, ...tools }) : []),
    link: query,
  };
  const edits = scene && watchEdits({ scan, scene, token, changed: () => mesh?.again() });
  const bar = embedded ? embeddedBar(scan, token, query) : titleBar(scan, token, viewing);
  const panels: Panel[] = [bar];
  const node = element('main', { class: 'scan-page' }, stage, empty, note, bar.element);
  if (floor) node.append(floor.element);
  const tools =
    scene && edits && !embedded
      ? toolsOf({ node, stage, canvas, scene, scan, options, cutting, edits, noting, token, frame: frameOf(view) })
      : null;
  if (scene && tools) {
    const buttons = [tools.live, tools.tape, tools.notes, tools.section, tools.frames].map(({ button }) => button);
    const legend = coverageLegend(options, scan, scene);
    panels.push(
      statusPanel(scan, () => scene.images.framesPerSecond()),
      viewPanel(options, scan, () => frameAll(scene, options), legend.element, ...buttons),
      ...Object.values(tools),
    );
    for (const panel of panels.slice(1)) node.append(panel.element);
    panels.push(legend); // stands in the panel of the view
  }
  const unsubscribers = [
    scene ? watchFreePart(node, stage, scene) : () => {},
    scan.subscribe((state) => showEmpty(empty, scene ? emptyText(state) : t.thisBrowserCannotShow3dPictures)),
    options.subscribe((state) => scene?.onOptions(state)),
    options.subscribe((state) => storeShow(ofThisBrowser, state.show)),
    scan.subscribe((state) => showEmpty(note, meshText(state.mesh, options.get().show === 'surface') || null)),
    options.subscribe((state) => showEmpty(note, meshText(scan.get().mesh, state.show === 'surface') || null)),
  ];
  const onEvent = (event: ScanEvent): void => {
    scene?.onEvent(event);
    tools?.live.onEvent(event);
  };
  const watch = (): Watch => watchOf(options.get(), scan.get().surfaceHasConfidences);
  const link = scene && new ScanLink({ scanId, token, watch: watch(), onEvent: receiver(scan.dispatch, onEvent) });
  for (const store of [options, scan]) unsubscribers.push(store.subscribe(() => link?.watch(watch())));
  const mesh = scene && watchMesh(scan, scene, token, async () => (await edits?.areThereAny()) ?? false);
  const stopReport = watchReport(scan, token);
  const stopAddress = embedded ? () => {} : watchAddress(scanId, query, [cutting, noting]);
  const plan = (): void => {
    const { title, phase } = scan.get();
    if (isOver(phase)) showFloorPlan(scanId, title, token);
  };
  const onKey = (event: KeyboardEvent): void => shortcut(event, { scanId, scene, options, tools, plan });
  document.addEventListener('keydown', onKey);
  canvas.addEventListener('dblclick', (event) => scene?.pivotAt(event.clientX, event.clientY));
  return {
    element: node,
    scan,
    drawCalls: () => scene?.drawCalls ?? 0,
    isResting: () => scene?.images.isResting ?? true,
    dispose() {
      document.removeEventListener('keydown', onKey);
      mesh?.dispose();
      edits?.dispose();
      link?.close();
      stopReport();
      stopAddress();
      floor?.dispose();
      for (const unsubscribe of unsubscribers) unsubscribe();
      for (const panel of panels) panel.dispose();
      scene?.dispose();
    },
  };
}

interface Tools {
  readonly live: LivePanel;
  readonly tape: MeasurePanel;
  readonly frames: FramesPanel;
  readonly section: SectionPanel;
  readonly notes: NotesPanel;
}

interface ToolWorld {
  readonly node: HTMLElement; // of the page
  readonly stage: HTMLElement;
  readonly canvas: HTMLCanvasElement;
  readonly scene: ScanScene;
  readonly scan: ScanStore;
  readonly options: OptionsStore;
  readonly cutting: Store<Cutting, CuttingEvent>;
  readonly edits: EditsWatch;
  readonly noting: Store<Noting, NotingEvent>;
  readonly token: string;
  readonly frame: number | null; // that the address names
}

// They stand in the same place: one at a time.
function toolsOf({ node, stage, canvas, scene, scan, options, cutting, edits, noting, token, frame }: ToolWorld): Tools {
  const tape = measurePanel({ canvas, scene, scan, token });
  const closeTape = (): void => {
    if (node.classList.contains('measuring')) tape.toggle();
  };
  const frames: FramesPanel = framesPanel({
    scene,
    scan,
    token,
    first: frame,
    opened() {
      closeTape();
      section.close();
      notes.close();
    },
  });
  const section: SectionPanel = sectionPanel({
    stage,
    canvas,
    scene,
    scan,
    store: cutting,
    edits,
    token,
    opened() {
      closeTape();
      frames.close();
      notes.close();
    },
  });
  const notes: NotesPanel = notesPanel({
    canvas,
    scene,
    scan,
    store: noting,
    token,
    opened() {
      closeTape();
      frames.close();
      section.close();
    },
  });
  for (const { close } of [frames, section, notes]) tape.button.addEventListener('click', close);
  const live = livePanel({ scene, scan, options, token, opened: section.close });
  return { live, tape, frames, section, notes };
}

function openScene(canvas: HTMLCanvasElement, onTouched: () => void): ScanScene | null {
  try {
    return new ScanScene(canvas, onTouched);
  } catch {
    return null; // said on the page
  }
}

function setFloor(scene: ScanScene, scanId: string, x_px: number, y_px: number): boolean {
  const up = scene.floorAt(x_px, y_px);
  if (up) storeUp(ofThisBrowser, scanId, up);
  return up !== null;
}

// Once, when there is one. The list of frames is asked for where there is more to say than that all were followed.
function watchReport(scan: ScanStore, token: string): () => void {
  const stopped = new AbortController();
  const load = async (scanId: string): Promise<void> => {
    const report = await patiently(() => fetchReport(scanId, token), stopped.signal);
    scan.dispatch({ kind: 'report', report });
    scan.dispatch({ kind: 'followed', followed: followedOf(report, null) });
    const { view, shared } = await patiently(() => fetchAccess(token), stopped.signal);
    const isPlain = report.weakFrames === 0 && report.trackedFrames === report.frames && scan.get().framesDropped === 0;
    if (isPlain || !view || shared) return;
    scan.dispatch({
      kind: 'followed',
      followed: followedOf(report, await patiently(() => fetchFrames(scanId, token, stopped.signal), stopped.signal)),
    });
  };
  let asked = false;
  const unsubscribe = scan.subscribe((state) => {
    const ended = state.connection === 'closed' && (state.phase === 'finished' || state.phase === 'interrupted');
    if (asked || !ended || state.framesProcessed === 0) return;
    asked = true;
    load(state.scanId).catch(() => {}); // what has come by then is said
  });
  return () => {
    stopped.abort();
    unsubscribe();
  };
}

// The address is that of what is seen. Browsers let it change only so often.
function watchAddress(scanId: string, query: () => string, stores: readonly Pick<Store<unknown, never>, 'subscribe'>[]): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let before = query();
  const onChange = (): void => {
    clearTimeout(timer);
    timer = setTimeout(() => {
      const now = query();
      if (now !== before) history.replaceState(null, '', hashOf(scanId, now));
      before = now;
    }, addressAfter_ms);
  };
  const unsubscribers = stores.map((store) => store.subscribe(onChange));
  return () => {
    clearTimeout(timer);
    for (const unsubscribe of unsubscribers) unsubscribe();
  };
}

interface ViewWorld {
  readonly scanId: string;
  readonly scene: ScanScene;
  readonly floor: FloorPicker;
  readonly frames: FramesPanel;
  readonly section: SectionPanel;
  readonly notes: NotesPanel;
  readonly options: OptionsStore;
}

function viewActions({ scanId, scene, floor, frames, section, notes, options }: ViewWorld): MenuItem[] {
  const chosen = storedUp(ofThisBrowser, scanId) !== null;
  const again = (): void => {
    storeUp(ofThisBrowser, scanId, null);
    scene.setUp(null);
  };
  return [
    ...(!notes.button.hidden ? [{ label: t.notes, phoneOnly: true, do: notes.toggle }] : []),
    ...(!section.button.hidden ? [{ label: t.section, phoneOnly: true, do: section.toggle }] : []),
    ...(!frames.button.hidden ? [{ label: t.frames, phoneOnly: true, do: frames.toggle }] : []),
    { label: t.coverage, phoneOnly: true, do: () => options.dispatch({ coverage: !options.get().coverage }) },
    { label: t.quality, phoneOnly: true, do: () => void (location.hash = qualityHash(scanId)) },
    { label: t.setTheFloor, do: () => floor.begin() },
    ...(chosen ? [{ label: t.findTheFloorAgain, do: again }] : []),
    { label: t.mouseAndKeyboard, do: showHelp },
    ...otherLanguages.map(([language, name]) => ({ label: name, do: () => chooseLanguage(language) })),
  ];
}

function isOver(phase: LiveScan['phase']): boolean {
  return phase === 'finished' || phase === 'failed' || phase === 'interrupted';
}

// What whoever looks may do with the scan.
function scanActions(scan: ScanStore, token: string, access: Access, problem: Element): MenuItem[] {
  const { scanId, title, phase, paused, canPause } = scan.get();
  const refused = (error: unknown): void => setText(problem, errorText(error));
  const stop = (): void => void stopScan(scanId, token).catch(refused);
  const pause = (): void => void pauseScan(scanId, !paused, token).catch(refused);
  const remove = (): void => {
    deleteSoon(scanId, title, token);
    location.hash = '#/';
  };
  const ended = isOver(phase);
  return [
    ...(access.scan
      ? [{ label: t.rename, do: () => rename(scanId, title, token, (wanted) => scan.dispatch({ kind: 'renamed', title: wanted })) }]
      : []),
    ...(access.scan && canPause ? [{ label: paused ? t.goOnScanning : t.pauseTheScan, do: pause }] : []),
    ...(access.scan && phase === 'running' ? [{ label: t.stopAndKeep, do: stop }] : []),
    ...(access.view && ended ? [{ label: t.floorPlan, do: () => showFloorPlan(scanId, title, token) }] : []),
    ...(access.view && !access.shared && ended ? [{ label: t.compareWith, do: () => chooseCompared(scanId, token) }] : []),
    ...(access.admin && ended ? [{ label: t.delete, bad: true, do: remove }] : []),
  ];
}

interface Viewing {
  readonly actions: () => MenuItem[]; // what else the menu has
  readonly link: () => string; // how the scan is looked at, as fields of an address
}

function titleBar(scan: ScanStore, token: string, viewing: Viewing): Panel {
  const title = element('h1');
  const phase = statusMark();
  const downloads = downloadMenu(scan, token);
  const problem = element('span', { class: 'problem', role: 'alert' });
  const share = shareButton(scan.get().scanId, token, problem, viewing.link);
  let access = noAccess;
  const shareItem: MenuItem = { label: t.share, phoneOnly: true, do: () => share.querySelector('button')?.click() };
  const embed = (): void => showEmbedding(scan.get().scanId, scan.get().title, token, viewing.link());
  const more = menu(t.more, () => [
    ...(access.scan ? [shareItem] : []),
    ...(access.scan && access.embedding ? [{ label: t.embed, do: embed }] : []),
    ...viewing.actions(),
    ...scanActions(scan, token, access, problem),
  ]);
  const node = element(
    'header',
    { class: 'title-bar' },
    element(
      'a',
      { class: 'back', href: '#/', 'aria-label': t.allScans },
      element('span', { 'aria-hidden': 'true' }, '←'),
      element('span', { class: 'back-words' }, ' Scans'),
    ),
    element('div', { class: 'heading' }, title, phase.element),
    element('span', { class: 'space' }),
    problem,
    share,
    downloads.element,
    more.element,
  );
  share.hidden = true;
  fetchAccess(token).then(
    (told) => {
      access = told;
      share.hidden = !(told.view && told.scan);
    },
    () => {}, // the connection of the scan says what is wrong
  );
  const unsubscribe = scan.subscribe((state) => {
    setText(title, state.title || t.scan);
    title.title = state.title;
    document.title = state.title ? `${state.title} – Hermite` : 'Hermite';
    phase.show(phaseText(state.phase, state.paused));
    phase.element.hidden = state.phase === 'unknown';
  });
  return {
    element: node,
    dispose() {
      unsubscribe();
      downloads.dispose();
      more.dispose();
    },
  };
}

function frameAll(scene: ScanScene, options: OptionsStore): void {
  options.dispatch({ follow: false });
  scene.frameAll();
}

function showEmpty(node: HTMLElement, text: string | null): void {
  node.hidden = text === null;
  if (text !== null) setText(node, text);
}

interface Shortcuts {
  readonly scanId: string;
  readonly scene: ScanScene | null;
  readonly options: OptionsStore;
  readonly tools: Tools | null;
  readonly plan: () => void; // shows the floor plan, of a scan that has ended
}

function shortcut(event: KeyboardEvent, { scanId, scene, options, tools, plan }: Shortcuts): void {
  const { target } = event;
  const typing = target instanceof HTMLTextAreaElement || (target instanceof HTMLInputElement && !['radio', 'range'].includes(target.type));
  if (typing || document.querySelector('dialog') || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === 'f' && scene) frameAll(scene, options);
  const now = options.get();
  if (event.key === 'c') options.dispatch({ follow: !now.follow });
  if (event.key === 's') options.dispatch({ show: now.show === 'surface' ? 'points' : 'surface' });
  if (event.key === 'i') options.dispatch({ hideBacks: !now.hideBacks });
  if (event.key === 'e') options.dispatch({ eyeDome: !now.eyeDome });
  if (event.key === 'l') tools?.live.toggle();
  if (event.key === 'v') options.dispatch({ coverage: !now.coverage });
  if (event.key === 'x') tools?.section.toggle();
  if (event.key === 'p') plan();
  if (event.key === 'q') location.hash = qualityHash(scanId);
  if (event.key === 'm') {
    tools?.frames.close();
    tools?.section.close();
    tools?.notes.close();
    tools?.tape.toggle();
  }
  if (event.key === 't') tools?.frames.toggle();
  if (event.key === 'n') tools?.notes.toggle();
  if (event.key === '?') showHelp();
}
