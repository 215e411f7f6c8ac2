// The clip box and the section plane: what is looked at of a model, and the lines where a plane
// cuts it, to be taken away as a drawing. With the box, parts of the scan are taken out.
import { fileNameOf, saveAs } from '../connection/api';
import type { ScanScene } from '../scene/scene';
import {
  rangeOf,
  sectionKinds,
  turnRange_deg,
  type Cutting,
  type CuttingEvent,
  type Model,
  type Section,
  type SectionKind,
} from '../state/cutting';
import type { LiveScan } from '../state/live_scan';
import { isThereAModel, ModelWatch } from '../state/model_watch';
import { joined, type Polyline } from '../state/section';
import { svgOf } from '../state/section_drawing';
import { dxfOf } from '../state/section_dxf';
import { drawingText, placeText, sectionName, sectionText } from '../state/section_text';
import type { Store } from '../state/store';
import { t } from '../texts/texts';
import { clipDrag } from './clip_drag';
import { buttonOf, element, setText, type Panel } from './dom';
import { editsView } from './edits_view';
import type { EditsWatch } from './edits_watch';
import { hintAtMore } from './scroll_hint';
import { segments } from './segments';

export interface SectionPanel extends Panel {
  readonly button: HTMLElement; // opens and closes it
  toggle(): void; // the same; nothing where there is nothing to cut
  close(): void;
}

interface World {
  readonly stage: HTMLElement;
  readonly canvas: HTMLCanvasElement;
  readonly scene: ScanScene;
  readonly scan: Store<LiveScan, never>;
  readonly store: Store<Cutting, CuttingEvent>;
  readonly edits: EditsWatch;
  readonly token: string;
  readonly opened: () => void; // it stands where others may stand
}

type Cut = SectionKind | 'off';

const cuts: readonly Cut[] = ['off', ...sectionKinds];
const cutLabels: Record<Cut, string> = {
  off: t.noSection,
  horizontal: t.horizontal,
  vertical: t.vertical,
};
// Steps of the plane: coarse ones from this size of the model on.
const steps_m = { fine: 0.001, coarse: 0.01, coarseFrom: 3 } as const;

export function sectionPanel({
  stage,
  canvas,
  scene,
  scan,
  store,
  edits,
  token,
  opened,
}: World): SectionPanel {
  const taking = editsView(edits, store, token);
  const view = panelView((by) => store.dispatch({ kind: 'cut', by }), taking.element);
  const { node, button } = view;
  let lines: readonly Polyline[] = [];
  const model = new ModelWatch(scene, store);
  const open = (active: boolean): void => {
    if (active === store.get().active) return;
    const hadFocus = node.contains(document.activeElement);
    if (active) {
      opened();
      model.remeasure();
    }
    store.dispatch({ kind: 'active', active });
    if (!active && hadFocus) button.focus();
  };
  const toggle = (): void => {
    if (!button.hidden) open(!store.get().active);
  };
  const show = (): void => {
    const state = store.get();
    node.parentElement?.classList.toggle('cutting', state.active);
    lines = joined(scene.showCutting(state));
    view.show(
      state,
      sectionText({ surface: scene.surface, lines }),
      scene.surface === 'finished' && lines.length > 0,
    );
  };
  wire(view, store, () => model.measure());
  view.svg.addEventListener('click', () => save(store.get(), scan.get().title, lines, 'svg'));
  view.dxf.addEventListener('click', () => save(store.get(), scan.get().title, lines, 'dxf'));
  button.addEventListener('click', toggle);
  view.done.addEventListener('click', () => open(false));
  const onKey = (event: KeyboardEvent): void => {
    if (event.key === 'Escape' && !event.defaultPrevented && !document.querySelector('dialog'))
      open(false);
  };
  document.addEventListener('keydown', onKey);
  const stopDrag = clipDrag(stage, canvas, scene, store);
  const stopHint = hintAtMore(node);
  const follow = (now: LiveScan): void => {
    button.hidden = !isThereAModel(now);
    model.follow(now);
  };
  const unsubscribers = [store.subscribe(show), scan.subscribe(follow)];
  return {
    element: node,
    button,
    toggle,
    close: () => open(false),
    dispose() {
      document.removeEventListener('keydown', onKey);
      stopDrag();
      stopHint();
      taking.dispose();
      for (const unsubscribe of unsubscribers) unsubscribe();
    },
  };
}

function save(
  { model, section }: Cutting,
  title: string,
  lines: readonly Polyline[],
  ending: 'svg' | 'dxf',
): void {
  if (!model || !section || lines.length === 0) return;
  const description = drawingText(model, section);
  const [text, type] =
    ending === 'svg'
      ? [svgOf(lines, { title, description }), 'image/svg+xml']
      : [dxfOf(lines, t.drawingInMetres(title, description)), 'image/vnd.dxf'];
  saveAs(
    new Blob([text], { type }),
    `${fileNameOf(title) || 'scan'}-${sectionName(model, section)}.${ending}`,
  );
}

type View = ReturnType<typeof panelView>;

function wire(
  { node, box, reset, takeOut, place, turn }: View,
  store: Store<Cutting, CuttingEvent>,
  measure: () => Model | null,
): void {
  box.addEventListener('click', () => store.dispatch({ kind: 'clip', on: !store.get().clip }));
  reset.addEventListener('click', () => {
    const model = measure();
    if (model) store.dispatch({ kind: 'reset', model });
  });
  takeOut.addEventListener('click', () =>
    takeOut.setAttribute('aria-expanded', String(node.classList.toggle('taking-out'))),
  );
  place.input.addEventListener('input', () =>
    store.dispatch({ kind: 'moved', at_m: place.input.valueAsNumber }),
  );
  turn.input.addEventListener('input', () =>
    store.dispatch({ kind: 'turned', turn_deg: turn.input.valueAsNumber }),
  );
}

function act(text: string, hint: string): HTMLButtonElement {
  return buttonOf(text, { title: hint });
}

function panelView(choose: (cut: Cut) => void, edits: HTMLElement) {
  const title = t.aClipBoxAndSectionsTo;
  const button = buttonOf(t.section, {
    class: 'button section-button',
    title,
    'aria-pressed': 'false',
  });
  const box = act(t.clipBox, t.showsOnlyWhatIsInsideOf);
  const reset = act(t.reset, t.makesTheBoxAsLargeAs);
  // On a phone, where there is room for the section or for what takes parts out.
  const takeOut = buttonOf(t.takeOut, { class: 'button take-out', 'aria-expanded': 'false' });
  const notice = element('p', { class: 'section-words', role: 'status' });
  const choice = segments('section-kind', t.sectionPlane, cuts, cutLabels, choose);
  const place = sliderOf('section-at', t.position, {});
  const turn = sliderOf('section-turn', t.turn, turnRange_deg);
  const done = act(t.close, t.theBoxAndThePlaneStay);
  const { files, svg, dxf } = fileButtons();
  const node = element(
    'section',
    { class: 'card section', 'aria-label': t.section },
    element('div', { class: 'buttons' }, box, reset, takeOut),
    edits,
    choice.element,
    place.element,
    turn.element,
    notice,
    element('div', { class: 'section-foot' }, files, done),
  );
  const show = ({ active, clip, section, model }: Cutting, say: string, isDrawn: boolean): void => {
    node.hidden = !active;
    button.setAttribute('aria-pressed', String(active));
    button.classList.toggle('in-use', clip !== null || section !== null);
    box.setAttribute('aria-pressed', String(clip !== null));
    reset.hidden = !clip;
    choice.check(section?.kind ?? 'off');
    place.element.hidden = notice.hidden = !section;
    turn.element.hidden = section?.kind !== 'vertical';
    files.hidden = !section || !isDrawn;
    setText(notice, section ? say : '');
    if (section && model) showSliders(section, model);
  };
  const showSliders = (section: Section, model: Model): void => {
    const [low_m, high_m] = rangeOf(model, section);
    place.input.min = String(low_m);
    place.input.max = String(high_m);
    place.input.step = String(high_m - low_m < steps_m.coarseFrom ? steps_m.fine : steps_m.coarse);
    place.input.value = String(section.at_m);
    place.say(placeText(model, section));
    turn.input.value = String(section.turn_deg);
    turn.say(`${Math.round(section.turn_deg)}°`);
  };
  return { node, button, box, reset, takeOut, choice, place, turn, svg, dxf, done, show };
}

// What the lines are taken away as.
function fileButtons() {
  const svg = act('SVG', t.aDrawingOnPaperWithIts);
  const dxf = act('DXF', t.forProgramsThatDrawInMetres);
  const download = element('span', {}, t.download);
  return { files: element('span', { class: 'section-files' }, download, svg, dxf), svg, dxf };
}

function sliderOf(id: string, label: string, range: Readonly<Record<string, number>>) {
  const input = element('input', { type: 'range', id, ...range });
  const text = element('output', { for: id });
  return {
    element: element(
      'label',
      { class: 'slider', for: id },
      element('span', {}, label),
      input,
      text,
    ),
    input,
    say(value: string): void {
      setText(text, value);
      input.setAttribute('aria-valuetext', value);
    },
  };
}
