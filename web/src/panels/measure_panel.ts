// The tape measure: clicks on the scan, what lies between them with its interval, and those
// measurements that are kept.
import { errorText } from '../connection/api';
import {
  measure,
  measureKinds,
  type KeptMeasurement,
  type Measured,
  type MeasureKind,
} from '../connection/measurements';
import type { ScanScene } from '../scene/scene';
import type { LiveScan } from '../state/live_scan';
import {
  canClose,
  freeName,
  initialMeasuring,
  measureLabels,
  measuringText,
  reduceMeasuring,
  type Measuring,
  type MeasuringEvent,
} from '../state/measuring';
import { createStore, type Store } from '../state/store';
import { t } from '../texts/texts';
import { buttonOf, element, setText, type Panel } from './dom';
import { KeptMeasurements } from './kept_measurements';
import { measureList, type Changes } from './measure_list';
import { segments } from './segments';
import { onTap } from './tap';

export interface MeasurePanel extends Panel {
  readonly button: HTMLElement; // begins and ends it
  toggle(): void; // the same; nothing where there is nothing to measure in
}

interface World {
  readonly canvas: HTMLCanvasElement;
  readonly scene: ScanScene;
  readonly scan: Store<LiveScan, never>;
  readonly token: string;
}

type MeasuringStore = Store<Measuring, MeasuringEvent>;

const onFirstCorner_px = 14; // a click as near to it closes the outline

export function measurePanel({ canvas, scene, scan, token }: World): MeasurePanel {
  const store: MeasuringStore = createStore(initialMeasuring, reduceMeasuring);
  const kept = new KeptMeasurements(scan.get().scanId, token, store.dispatch, () => show());
  const view = panelView((kind) => store.dispatch({ kind: 'wanted', measure: kind }));
  const { node, button, undo, close, csv, done } = view;
  const begin = (active: boolean): void => {
    store.dispatch({ kind: 'active', active });
    if (active) kept.load();
  };
  const toggle = (): void => {
    if (!button.hidden) begin(!store.get().active);
  };
  const { dispatch, choose, closeBy } = picking({ canvas, scene, scan, token }, store);
  const show = (): void => {
    const state = store.get();
    canvas.classList.toggle('picking', state.active);
    node.parentElement?.classList.toggle('measuring', state.active);
    view.show(state, kept.mayChange ? kept : null);
    scene.showMeasured(
      state.active ? [...state.kept, ...(state.newest ? [state.newest] : [])] : [],
      state.points,
    );
  };
  const onKey = (event: KeyboardEvent): void => {
    const state = store.get();
    if (!state.active || document.querySelector('dialog')) return;
    if (event.key === 'Escape') begin(state.points.length > 0); // first the points, then the tool
    if (isForControl(event, button)) return;
    if (event.key === 'Backspace') dispatch({ kind: 'undone' });
    if (event.key === 'Enter' && state.points.length > 0) {
      event.preventDefault(); // the button that began it may still have the focus
      dispatch({ kind: 'closed' });
    }
  };
  button.addEventListener('click', toggle);
  done.addEventListener('click', () => begin(false));
  undo.addEventListener('click', () => dispatch({ kind: 'undone' }));
  close.addEventListener('click', () => dispatch({ kind: 'closed' }));
  csv.addEventListener('click', () => kept.save(scan.get().title));
  onTap(canvas, choose);
  canvas.addEventListener('dblclick', closeBy);
  document.addEventListener('keydown', onKey);
  const unsubscribers = [
    store.subscribe(show),
    scan.subscribe((state) => {
      const ended = state.phase === 'finished' || state.phase === 'interrupted';
      // No camera has seen what was imported.
      button.hidden = !ended || state.framesReceived === 0 || state.points === 0;
      if (button.hidden && store.get().active) begin(false);
    }),
  ];
  return {
    element: node,
    button,
    toggle,
    dispose() {
      document.removeEventListener('keydown', onKey);
      view.dispose();
      for (const unsubscribe of unsubscribers) unsubscribe();
    },
  };
}

// How clicks on the scan become a measurement.
function picking({ scene, scan, token }: World, store: MeasuringStore) {
  // The server is asked as soon as nothing is missing. What it says of points that are not
  // asked for any more is none.
  const dispatch = (event: MeasuringEvent): void => {
    const before = store.get();
    store.dispatch(event);
    const { busy, measure: kind, points } = store.get();
    if (before.busy || !busy) return;
    const isAsked = (): boolean => store.get().busy && store.get().points === points;
    measure(scan.get().scanId, token, {
      kind,
      points,
      ...(kind === 'height' ? { up: scene.up } : {}),
    }).then(
      (measured) => isAsked() && store.dispatch({ kind: 'measured', measured }),
      (error) => isAsked() && store.dispatch({ kind: 'failed', message: errorText(error) }),
    );
  };
  const choose = (x_px: number, y_px: number): void => {
    const state = store.get();
    if (!state.active || state.busy) return;
    const start = canClose(state) ? scene.screenOf(state.points[0]!) : null;
    if (start && Math.hypot(x_px - start[0], y_px - start[1]) <= onFirstCorner_px)
      dispatch({ kind: 'closed' });
    else dispatch({ kind: 'chosen', place: scene.placeAt(x_px, y_px) });
  };
  // The first click of a double click was a corner. Nothing else is to come of it.
  const closeBy = (event: MouseEvent): void => {
    if (!store.get().active || store.get().measure !== 'area') return;
    event.stopImmediatePropagation();
    dispatch({ kind: 'closed' });
  };
  return { dispatch, choose, closeBy };
}

// Whether a key is meant for what has the focus: text that is written, a button that is pressed.
function isForControl(event: KeyboardEvent, button: HTMLElement): boolean {
  const { target } = event;
  if (target instanceof HTMLInputElement) return target.type !== 'radio';
  return target instanceof HTMLButtonElement && target !== button;
}

// What the panel is made of. Its `show` is given no changes for whoever may only look.
function panelView(choose: (kind: MeasureKind) => void) {
  const button = buttonOf(t.measure, {
    title: t.measuresDistancesHeightsAnglesAndAreas,
    'aria-pressed': 'false',
  });
  const choice = segments('measure-kind', t.whatIsMeasured, measureKinds, measureLabels, choose);
  const prompt = element('p', { class: 'measure-words', role: 'status' });
  const undo = buttonOf(t.undo, { title: t.takesTheLastPointBackBackspace });
  const close = buttonOf(t.closeTheOutline, {
    class: 'button primary',
    title: t.connectsTheLastCornerWithThe,
  });
  const steps = element('div', { class: 'buttons' }, close, undo);
  const newest = element('div', { class: 'measure-newest' });
  const list = measureList();
  const csv = buttonOf(t.downloadCsv);
  const done = buttonOf(t.close);
  const ends = element('div', { class: 'buttons panel-foot' }, csv, done);
  const node = element(
    'section',
    { class: 'card measure', 'aria-label': t.measure },
    choice.element,
    prompt,
    steps,
    newest,
    list.element,
    ends,
  );
  const show = (state: Measuring, changes: Changes | null): void => {
    node.hidden = !state.active;
    button.setAttribute('aria-pressed', String(state.active));
    choice.check(state.measure);
    setText(prompt, measuringText(state));
    undo.hidden = state.points.length === 0 || state.busy;
    close.hidden = !canClose(state);
    steps.hidden = undo.hidden && close.hidden;
    newest.hidden = !state.newest;
    if (state.newest) newest.replaceChildren(...newestRow(state.newest, state.kept, changes));
    csv.hidden = state.kept.length === 0;
    list.show(state.kept, changes);
  };
  return { node, button, undo, close, csv, done, show, dispose: list.dispose };
}

function newestRow(
  measured: Measured,
  kept: readonly KeptMeasurement[],
  changes: Changes | null,
): HTMLElement[] {
  const value = element('strong', {}, measured.words);
  if (!changes) return [value];
  const name = element('input', {
    type: 'text',
    value: freeName(kept, measured.kind),
    'aria-label': t.nameOfTheMeasurement,
    maxlength: 200,
    required: true,
    autocomplete: 'off',
  });
  const form = element(
    'form',
    {},
    name,
    element('button', { type: 'submit', class: 'button primary' }, t.keep),
  );
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    if (name.value.trim() !== '') changes.keep(name.value.trim(), measured);
  });
  return [value, form];
}
