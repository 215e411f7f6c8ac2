// The page of one scan: the image fills it, the panels float above. Wires the connection, the
// ledger, the state and the scene together.
import type { ScanEvent, Watch } from '../connection/events';
import { ScanLink } from '../connection/link';
import { ScanScene } from '../scene/scene';
import { watchAddress } from '../state/address_watch';
import { isEmbedded } from '../state/embed';
import {
  initialLiveScan,
  reduceLiveScan,
  type LiveScan,
  type LiveScanEvent,
} from '../state/live_scan';
import { beginLooking } from '../state/looking';
import { receiver } from '../state/receiver';
import { frameOf, qualityHash } from '../state/route';
import { ofThisBrowser, ofThisTab } from '../state/storages';
import { createStore, type Store } from '../state/store';
import { storeShow, watchOf, type ViewOptions } from '../state/view_options';
import { t } from '../texts/texts';
import { coverageLegend } from './coverage_legend';
import { showHelp } from './dialogs';
import { element, type Panel } from './dom';
import { watchEdits, type EditsWatch } from './edits_watch';
import { embeddedBar } from './embedded_bar';
import { floorChoice, type FloorChoice } from './floor_choice';
import { watchFreePart } from './free_watch';
import { imageWords } from './image_words';
import { chooseLanguage, otherLanguages } from './language_choice';
import type { MenuItem } from './menu';
import { watchMesh } from './mesh_watch';
import { watchReport } from './report_watch';
import { onScanKeys } from './scan_keys';
import { toolsOf, type Tools } from './scan_tools';
import { statusPanel } from './status_panel';
import { watchSummary } from './summary_watch';
import { titleBar } from './title_bar';
import { viewPanel } from './view_panel';

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
  const looking = beginLooking(scanId, { view, browser: ofThisBrowser, tab: ofThisTab });
  const { options, cutting, noting, query } = looking;
  const { canvas, stage } = pictureOf();
  const scene = openScene(canvas, () => options.dispatch({ follow: false }));
  const words = imageWords(scan, options, scene !== null);
  const floor = scene && floorChoice(canvas, scene, scanId);
  const surface = scene && watchSurface(scan, scene, token);
  const embedded = isEmbedded(view);
  const actions = (): MenuItem[] =>
    floor && tools ? viewActions({ scanId, floor, options, ...tools }) : [];
  const bar = embedded
    ? embeddedBar(scan, token, query)
    : titleBar(scan, token, { actions, link: query });
  const inside = [stage, ...words.elements, bar.element, floor?.element ?? null];
  const node = element('main', { class: 'scan-page' }, ...inside);
  const tools =
    scene && surface && !embedded
      ? toolsOf({
          ...looking,
          node,
          stage,
          canvas,
          scene,
          scan,
          edits: surface.edits,
          token,
          frame: frameOf(view),
        })
      : null;
  const frameAll = (): void => {
    if (!scene) return;
    options.dispatch({ follow: false });
    scene.frameAll();
  };
  const panels = [
    bar,
    ...(scene && tools ? addPanels(node, { scan, options, scene, tools, frameAll }) : []),
  ];
  const onEvent = (event: ScanEvent): void => {
    scene?.onEvent(event);
    tools?.live.onEvent(event);
  };
  const ends = [
    scene ? watchFreePart(node, stage, scene) : () => {},
    options.subscribe((state) => scene?.onOptions(state)),
    options.subscribe((state) => storeShow(ofThisBrowser, state.show)),
    onScanKeys({ scan, options, tools, token, frameAll }),
    scene ? openLink(scan, options, token, onEvent) : () => {},
    watchReport(scan, token),
    watchSummary(scan, token),
    embedded ? () => {} : watchAddress(scanId, query, [cutting, noting]),
  ];
  canvas.addEventListener('dblclick', (event) => scene?.pivotAt(event.clientX, event.clientY));
  return {
    element: node,
    scan,
    drawCalls: () => scene?.drawCalls ?? 0,
    isResting: () => scene?.images.isResting ?? true,
    dispose() {
      for (const end of ends) end();
      for (const part of [surface, floor, words, ...panels, scene]) part?.dispose();
    },
  };
}

function pictureOf() {
  const canvas = element('canvas', {
    class: 'picture',
    tabindex: 0,
    'aria-label': t.theScanInThreeDimensionsArrow,
  });
  return { canvas, stage: element('div', { class: 'stage' }, canvas) };
}

function openScene(canvas: HTMLCanvasElement, onTouched: () => void): ScanScene | null {
  try {
    return new ScanScene(canvas, onTouched);
  } catch {
    return null; // said on the page
  }
}

// The finished surface is made and loaded again when the edits have changed.
function watchSurface(
  scan: ScanStore,
  scene: ScanScene,
  token: string,
): { readonly edits: EditsWatch; dispose(): void } {
  const edits = watchEdits({ scan, scene, token, changed: () => mesh.again() });
  const mesh = watchMesh({ scan, scene, token, isEdited: () => edits.areThereAny() });
  return {
    edits,
    dispose() {
      mesh.dispose();
      edits.dispose();
    },
  };
}

// Asks the server for what is looked at of the scan. Returns how to stop.
function openLink(
  scan: ScanStore,
  options: OptionsStore,
  token: string,
  onEvent: (event: ScanEvent) => void,
): () => void {
  const watch = (): Watch => watchOf(options.get(), scan.get().surfaceHasConfidences);
  const { scanId } = scan.get();
  const link = new ScanLink({
    scanId,
    token,
    watch: watch(),
    onEvent: receiver(scan.dispatch, onEvent),
  });
  const unsubscribers = [options, scan].map((store) => store.subscribe(() => link.watch(watch())));
  return () => {
    link.close();
    for (const unsubscribe of unsubscribers) unsubscribe();
  };
}

interface PanelWorld {
  readonly scan: ScanStore;
  readonly options: OptionsStore;
  readonly scene: ScanScene;
  readonly tools: Tools;
  readonly frameAll: () => void;
}

function addPanels(
  node: HTMLElement,
  { scan, options, scene, tools, frameAll }: PanelWorld,
): Panel[] {
  const buttons = [tools.live, tools.tape, tools.notes, tools.section, tools.frames].map(
    ({ button }) => button,
  );
  const legend = coverageLegend(options, scan, scene);
  const panels = [
    statusPanel(scan, () => scene.images.framesPerSecond()),
    viewPanel(options, scan, frameAll, legend.element, ...buttons),
    ...Object.values(tools),
  ];
  node.append(...panels.map((panel) => panel.element));
  return [...panels, legend]; // which stands in the panel of the view
}

interface ViewWorld extends Pick<Tools, 'frames' | 'section' | 'notes'> {
  readonly scanId: string;
  readonly floor: FloorChoice;
  readonly options: OptionsStore;
}

function viewActions({ scanId, floor, frames, section, notes, options }: ViewWorld): MenuItem[] {
  return [
    ...(!notes.button.hidden ? [{ label: t.notes, phoneOnly: true, do: notes.toggle }] : []),
    ...(!section.button.hidden ? [{ label: t.section, phoneOnly: true, do: section.toggle }] : []),
    ...(!frames.button.hidden ? [{ label: t.frames, phoneOnly: true, do: frames.toggle }] : []),
    {
      label: t.coverage,
      phoneOnly: true,
      do: () => options.dispatch({ coverage: !options.get().coverage }),
    },
    { label: t.quality, phoneOnly: true, do: () => void (location.hash = qualityHash(scanId)) },
    ...floor.actions(),
    { label: t.mouseAndKeyboard, do: showHelp },
    ...otherLanguages.map(([language, name]) => ({
      label: name,
      do: () => chooseLanguage(language),
    })),
  ];
}
