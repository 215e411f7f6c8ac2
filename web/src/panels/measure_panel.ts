// The tape measure: two clicks on the scan, what lies between them with its interval, and those that are kept.
import { ApiError, fileNameOf, saveAs } from '../connection/api';
import { fetchMeasurements, fetchMeasurementsCsv, keepMeasurement, measure, removeMeasurement, type KeptMeasurement, type Measured } from '../connection/measurements';
import { fetchAccess, noAccess } from '../connection/scans';
import type { ScanScene } from '../scene/scene';
import type { LiveScan } from '../state/live_scan';
import { freeName, initialMeasuring, measuringWords, reduceMeasuring, type Measuring, type MeasuringEvent } from '../state/measuring';
import { createStore, type Store } from '../state/store';
import { element, setText, type Panel } from './dom';
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

export function measurePanel({ canvas, scene, scan, token }: World): MeasurePanel {
  const store: MeasuringStore = createStore(initialMeasuring, reduceMeasuring);
  const { scanId } = scan.get();
  const button = element('button', { type: 'button', class: 'button', title: 'Measures the distance of two points (M)', 'aria-pressed': 'false' }, 'Measure');
  const words = element('p', { class: 'measure-words', role: 'status' });
  const newest = element('div', { class: 'measure-newest' });
  const list = element('ul', { class: 'measure-list' });
  const csv = element('button', { type: 'button', class: 'button' }, 'Download CSV');
  const done = element('button', { type: 'button', class: 'button' }, 'Close');
  const node = element('section', { class: 'card measure', 'aria-label': 'Measure' }, words, newest, list, element('div', { class: 'buttons' }, csv, done));
  let access = noAccess;
  const fail = (error: unknown): void => store.dispatch({ kind: 'failed', words: error instanceof ApiError ? error.message : 'That did not work.' });
  const begin = (active: boolean): void => {
    store.dispatch({ kind: 'active', active });
    if (!active) return;
    fetchMeasurements(scanId, token).then((kept) => store.dispatch({ kind: 'listed', kept }), fail);
    fetchAccess(token).then((told) => {
      access = told;
      show();
    }, fail);
  };
  const toggle = (): void => {
    if (!button.hidden) begin(!store.get().active);
  };
  const choose = (x_px: number, y_px: number): void => {
    const { active, busy, first } = store.get();
    if (!active || busy) return;
    const place = scene.placeAt(x_px, y_px);
    store.dispatch({ kind: 'chosen', place });
    if (first && place) measure(scanId, token, first, place).then((measured) => store.dispatch({ kind: 'measured', measured }), fail);
  };
  const keep = (name: string, measured: Measured): void => void keepMeasurement(scanId, token, name, measured).then((one) => store.dispatch({ kind: 'kept', one }), fail);
  const remove = ({ id }: KeptMeasurement): void => void removeMeasurement(scanId, token, id).then(() => store.dispatch({ kind: 'removed', id }), fail);
  const show = (): void => {
    const state = store.get();
    node.hidden = !state.active;
    canvas.classList.toggle('picking', state.active);
    node.parentElement?.classList.toggle('measuring', state.active);
    button.setAttribute('aria-pressed', String(state.active));
    setText(words, measuringWords(state));
    newest.hidden = !state.newest;
    if (state.newest) newest.replaceChildren(...newestRow(state.newest, state.kept, access.scan ? keep : null));
    list.hidden = csv.hidden = state.kept.length === 0;
    list.replaceChildren(...state.kept.map((one) => rowOf(one, access.scan ? remove : null)));
    scene.showMeasured(state.active ? [...state.kept, ...(state.newest ? [state.newest] : [])] : [], state.first);
  };
  const onKey = (event: KeyboardEvent): void => {
    if (event.key === 'Escape' && store.get().active && !document.querySelector('dialog')) begin(store.get().first !== null); // first the point, then the tool
  };
  button.addEventListener('click', toggle);
  done.addEventListener('click', () => begin(false));
  csv.addEventListener('click', () => void fetchMeasurementsCsv(scanId, token).then((file) => saveAs(file, `${fileNameOf(scan.get().title) || 'scan'}-measurements.csv`), fail));
  onTap(canvas, choose);
  document.addEventListener('keydown', onKey);
  const unsubscribers = [
    store.subscribe(show),
    scan.subscribe((state) => {
      const ended = state.phase === 'finished' || state.phase === 'interrupted';
      button.hidden = !ended || state.framesReceived === 0 || state.points === 0; // no camera has seen what was imported
      if (button.hidden && store.get().active) begin(false);
    }),
  ];
  return {
    element: node,
    button,
    toggle,
    dispose() {
      document.removeEventListener('keydown', onKey);
      for (const unsubscribe of unsubscribers) unsubscribe();
    },
  };
}

// `keep` is null for whoever may only look.
function newestRow(measured: Measured, kept: readonly KeptMeasurement[], keep: ((name: string, measured: Measured) => void) | null): HTMLElement[] {
  const words = element('strong', {}, measured.words);
  if (!keep) return [words];
  const name = element('input', { type: 'text', value: freeName(kept), 'aria-label': 'Name of the distance', maxlength: 200, required: true, autocomplete: 'off' });
  const form = element('form', {}, name, element('button', { type: 'submit', class: 'button primary' }, 'Keep'));
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    if (name.value.trim() !== '') keep(name.value.trim(), measured);
  });
  return [words, form];
}

function rowOf(one: KeptMeasurement, remove: ((one: KeptMeasurement) => void) | null): HTMLElement {
  const row = element('li', {}, element('div', {}, element('span', { class: 'measure-name' }, one.name), element('span', {}, one.words)));
  if (!remove) return row;
  const button = element('button', { type: 'button', class: 'button', 'aria-label': `Remove ${one.name}` }, '×');
  button.addEventListener('click', () => remove(one));
  row.append(button);
  return row;
}
