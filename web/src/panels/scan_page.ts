// The page of one scan: the picture fills it, the panels float above. Wires the connection, the ledger, the state and the scene together.
import type { ScanEvent, Watch } from '../connection/events';
import { ScanLink } from '../connection/link';
import { ScanScene } from '../scene/scene';
import { ChunkLedger, nameOf, nameOfCube, pointLimit, triangleLimit, type Verdict } from '../state/chunk_ledger';
import { initialLiveScan, reduceLiveScan, type LiveScan, type LiveScanEvent } from '../state/live_scan';
import { meshWords } from '../state/mesh';
import { createStore, type Store } from '../state/store';
import { initialViewOptions, reduceViewOptions, storedShow, storeShow, type ViewOptions } from '../state/view_options';
import { emptyWords, phaseWords } from '../state/words';
import { element, setText, type Panel } from './dom';
import { downloadMenu } from './download_menu';
import { statusMark } from './mark';
import { watchMesh } from './mesh_watch';
import { shareButton } from './share_button';
import { statusPanel } from './status_panel';
import { viewPanel } from './view_panel';

const sharePrefix = 'hms_'; // who came by a share link cannot make another

export interface ScanPage extends Panel {
  readonly scan: Store<LiveScan, LiveScanEvent>;
}

export function scanPage(scanId: string, token: string): ScanPage {
  const scan = createStore(initialLiveScan(scanId), reduceLiveScan);
  const options = createStore<ViewOptions, Partial<ViewOptions>>({ ...initialViewOptions, show: storedShow(localStorage) }, reduceViewOptions);
  const canvas = element('canvas', { class: 'picture', tabindex: 0, 'aria-label': 'The scan in three dimensions. Arrow keys move, plus and minus zoom.' });
  const stage = element('div', { class: 'stage' }, canvas);
  const empty = element('p', { class: 'empty', role: 'status' });
  const scene = openScene(canvas, () => options.dispatch({ follow: false }));
  const note = element('p', { class: 'mesh-note', role: 'status' });
  const bar = titleBar(scan, token);
  const panels: Panel[] = [bar];
  const node = element('main', { class: 'scan-page' }, stage, empty, note, bar.element);
  if (scene) {
    panels.push(statusPanel(scan, () => scene.framesPerSecond()));
    panels.push(viewPanel(options, scan, () => frameAll(scene, options)));
    for (const panel of panels.slice(1)) node.append(panel.element);
  }
  const unsubscribers = [
    scan.subscribe((state) => showEmpty(empty, scene ? emptyWords(state) : 'This browser cannot show 3D pictures: it has no WebGL 2.')),
    options.subscribe((state) => scene?.onOptions(state)),
    options.subscribe((state) => storeShow(localStorage, state.show)),
    scan.subscribe((state) => showEmpty(note, meshWords(state.mesh, options.get().show === 'surface') || null)),
    options.subscribe((state) => showEmpty(note, meshWords(scan.get().mesh, state.show === 'surface') || null)),
  ];
  const link = scene && new ScanLink({ scanId, token, watch: watchOf(options.get()), onEvent: receiver(scan, scene) });
  unsubscribers.push(options.subscribe((state) => link?.watch(watchOf(state))));
  const mesh = scene && watchMesh(scan, scene, token);
  const onKey = (event: KeyboardEvent): void => shortcut(event, scene, options);
  document.addEventListener('keydown', onKey);
  return {
    element: node,
    scan,
    dispose() {
      document.removeEventListener('keydown', onKey);
      mesh?.dispose();
      link?.close();
      for (const unsubscribe of unsubscribers) unsubscribe();
      for (const panel of panels) panel.dispose();
      scene?.dispose();
    },
  };
}

// What is shown is what is asked for.
function watchOf({ show }: ViewOptions): Watch {
  return { points: show === 'points', mesh: show === 'surface' };
}

// Chunks pass the ledger first; the scene only gets what is new, the state only the counts.
function receiver(scan: Store<LiveScan, LiveScanEvent>, scene: ScanScene): (event: ScanEvent) => void {
  const chunks = new ChunkLedger(nameOf, pointLimit);
  const pieces = new ChunkLedger(nameOfCube, triangleLimit);
  let full = false;
  const verdictOn = (event: ScanEvent): Verdict => {
    if (event.kind === 'chunk') return chunks.accept(event.key, event.version, event.points?.count ?? 0);
    if (event.kind === 'meshChunk') return pieces.accept(event.cube, event.version, event.piece?.triangles ?? 0);
    return 'apply';
  };
  return (event) => {
    if (event.kind === 'welcome') {
      chunks.beginSnapshot();
      pieces.beginSnapshot();
    }
    const verdict = verdictOn(event);
    full ||= verdict === 'full';
    if (verdict === 'apply') scene.onEvent(event);
    if (event.kind === 'snapshotEnd') {
      for (const key of chunks.endSnapshot()) scene.onEvent({ kind: 'chunk', key, version: 0n, points: null });
      for (const cube of pieces.endSnapshot()) scene.onEvent({ kind: 'meshChunk', cube, version: 0n, submap: 0, piece: null });
    }
    scan.dispatch(event);
    if (event.kind === 'chunk' || event.kind === 'meshChunk' || event.kind === 'snapshotEnd') {
      scan.dispatch({ kind: 'content', points: chunks.size, chunks: chunks.chunks, triangles: pieces.size, full });
    }
  };
}

function openScene(canvas: HTMLCanvasElement, onTouched: () => void): ScanScene | null {
  try {
    return new ScanScene(canvas, onTouched);
  } catch {
    return null; // said in words on the page
  }
}

function titleBar(scan: Store<LiveScan, LiveScanEvent>, token: string): Panel {
  const title = element('h1');
  const phase = statusMark();
  const downloads = downloadMenu(scan, token);
  const problem = element('span', { class: 'problem', role: 'alert' });
  const node = element(
    'header',
    { class: 'title-bar' },
    element('a', { class: 'back', href: '#/', 'aria-label': 'All scans' }, element('span', { 'aria-hidden': 'true' }, '←'), element('span', { class: 'back-words' }, ' Scans')),
    element('div', { class: 'heading' }, title, phase.element),
    element('span', { class: 'space' }),
    problem,
    token.startsWith(sharePrefix) ? null : shareButton(scan.get().scanId, token, problem),
    downloads.element,
  );
  const unsubscribe = scan.subscribe((state) => {
    setText(title, state.title || 'Scan');
    title.title = state.title;
    document.title = state.title ? `${state.title} – Hermite` : 'Hermite';
    phase.show(phaseWords(state.phase));
    phase.element.hidden = state.phase === 'unknown';
  });
  return {
    element: node,
    dispose() {
      unsubscribe();
      downloads.dispose();
    },
  };
}

function frameAll(scene: ScanScene, options: Store<ViewOptions, Partial<ViewOptions>>): void {
  options.dispatch({ follow: false });
  scene.frameAll();
}

function showEmpty(node: HTMLElement, words: string | null): void {
  node.hidden = words === null;
  if (words !== null) setText(node, words);
}

function shortcut(event: KeyboardEvent, scene: ScanScene | null, options: Store<ViewOptions, Partial<ViewOptions>>): void {
  const typing = event.target instanceof HTMLInputElement && event.target.type !== 'radio';
  if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === 'f' && scene) frameAll(scene, options);
  if (event.key === 'c') options.dispatch({ follow: !options.get().follow });
}
