// Everything that a finished scan can be taken away as. What is not there yet is made by the server first; who has asked for it gets it when it is ready.
import { errorText, fileNameOf, saveAs } from '../connection/api';
import {
  asItIs,
  fetchExport,
  fetchExports,
  finishedAs,
  importedMesh,
  isMade,
  removeExport,
  requestExport,
  type MeshFinish,
  type ScanExport,
} from '../connection/exports';
import { fetchAccess } from '../connection/scans';
import type { LiveScan } from '../state/live_scan';
import type { Store } from '../state/store';
import { exportText, kindText } from '../state/text';
import { t } from '../texts/texts';
import { element, setText, type Panel } from './dom';
import { downloadRow, type DownloadRow } from './download_row';
import { madeExports } from './made_exports';

const pollEvery_ms = 1_500;

export function downloadMenu(scan: Store<LiveScan, never>, token: string): Panel {
  const button = element('button', { type: 'button', class: 'button', 'aria-expanded': 'false', 'aria-controls': 'downloads' }, t.download);
  const notice = element('p', { class: 'notice', role: 'status' });
  const list = element('div', { class: 'download-list' });
  const close = element('button', { type: 'button', class: 'button close', 'aria-label': t.closeTheDownloads }, t.close);
  const textOf = (one: ScanExport): string => exportText(one, loaded_bytes.get(one.format) ?? null);
  const find = (format: string): ScanExport | undefined => exports.find((one) => one.format === format);
  const made = madeExports({ take: (format) => void take(() => find(format)), remove: (format) => void remove(format), textOf });
  const menu = element(
    'section',
    { id: 'downloads', class: 'card downloads', 'aria-label': t.downloads },
    element('h2', {}, t.download),
    close,
    notice,
    list,
    made.element,
  );
  const node = element('div', { class: 'download' }, button, menu);
  const { scanId } = scan.get();
  const rows = new Map<string, DownloadRow>();
  const wanted = new Set<string>(); // formats that are taken as soon as they are ready
  const loaded_bytes = new Map<string, number>(); // of those that are just taken
  let finish = asItIs; // of meshes
  let exports: readonly ScanExport[] = [];
  let mayRemove = false;
  let timer: ReturnType<typeof setTimeout> | undefined;
  let disposed = false;
  menu.hidden = true;

  const say = (text: string): void => {
    notice.hidden = text === '';
    setText(notice, text);
  };
  // A row for each format; of a mesh it says how far that is which has the chosen finish.
  const formats = (): ScanExport[] => exports.filter((one) => !isMade(one));
  const chosen = (one: ScanExport): ScanExport => (isFinished(one) ? finishedAs(exports, one, finish) : one);
  const show = (): void => {
    if (formats().some((one) => !rows.has(one.format))) build();
    for (const one of formats()) rows.get(one.format)?.show(chosen(one));
    made.show(exports, mayRemove);
  };
  const choices = finishChoices((now) => {
    finish = now;
    show();
  });
  const build = (): void => {
    rows.clear();
    const kinds = [...new Set(formats().map((one) => one.kind))];
    list.replaceChildren(
      ...kinds.map((kind) => {
        const ofKind = formats().filter((one) => one.kind === kind);
        return element(
          'div',
          { class: 'download-kind' },
          element('h3', {}, kindText(kind)),
          ofKind.some(isFinished) ? choices : null,
          ...ofKind.map((one) => addRow(one).element),
        );
      }),
    );
  };
  const addRow = (one: ScanExport): DownloadRow => {
    const asChosen = (): ScanExport | undefined => {
      const plain = find(one.format);
      return plain && chosen(plain);
    };
    const row = downloadRow(one.label, () => void take(asChosen), textOf);
    rows.set(one.format, row);
    return row;
  };
  const attempt = async (work: () => Promise<void>): Promise<void> => {
    try {
      await work();
    } catch (error) {
      say(errorText(error));
    }
    if (!disposed) show();
  };
  const put = (one: ScanExport): void => {
    const isThere = exports.some((old) => old.format === one.format);
    exports = isThere ? exports.map((old) => (old.format === one.format ? one : old)) : [...exports, one];
  };
  const take = (wantedNow: () => ScanExport | undefined): Promise<void> =>
    attempt(async () => {
      say('');
      let one = wantedNow();
      if (!one || loaded_bytes.has(one.format)) return;
      if (one.state === 'ready') return save(one);
      if (one.state === 'missing' || one.state === 'failed') put((one = await requestExport(scanId, one.of_format, token, one.finish)));
      wanted.add(one.format);
      poll();
    });
  const remove = (format: string): Promise<void> =>
    attempt(async () => {
      say('');
      await removeExport(scanId, format, token);
      wanted.delete(format);
      await refresh();
    });
  const save = async (one: ScanExport): Promise<void> => {
    wanted.delete(one.format);
    loaded_bytes.set(one.format, 0);
    show();
    try {
      const blob = await fetchExport(scanId, one.format, token, (bytes) => {
        loaded_bytes.set(one.format, bytes);
        show();
      });
      if (!disposed) saveAs(blob, downloadName(scan.get(), one.file));
    } finally {
      loaded_bytes.delete(one.format);
    }
  };
  const refresh = async (): Promise<void> => {
    exports = await fetchExports(scanId, token);
    if (disposed) return;
    show();
    for (const one of exports.filter(({ format }) => wanted.has(format))) {
      if (one.state === 'ready') void attempt(() => save(one));
      if (one.state === 'failed' || one.state === 'missing') wanted.delete(one.format);
    }
  };
  // While somebody looks or waits and something is going on.
  const poll = (): void => {
    clearTimeout(timer);
    timer = setTimeout(() => void attempt(refresh).then(pollOn), pollEvery_ms);
  };
  const pollOn = (): void => {
    const busy = exports.some((one) => one.state === 'queued' || one.state === 'running');
    if (!disposed && (wanted.size > 0 || (busy && !menu.hidden))) poll();
  };
  const open = (on: boolean): void => {
    menu.hidden = !on;
    button.setAttribute('aria-expanded', String(on));
    if (!on) return;
    if (exports.length === 0) say(t.loadingNow);
    fetchAccess(token).then(
      (access) => {
        mayRemove = access.scan;
        if (!disposed) show();
      },
      () => {}, // what may not be removed cannot be known
    );
    void attempt(async () => {
      await refresh();
      say('');
    }).then(pollOn);
  };
  button.addEventListener('click', () => open(menu.hidden));
  close.addEventListener('click', () => {
    open(false);
    button.focus();
  });
  const onOutside = (event: Event): void => {
    if (!menu.hidden && event.target instanceof Node && !node.contains(event.target)) open(false);
  };
  const onKey = (event: KeyboardEvent): void => {
    if (event.key !== 'Escape' || menu.hidden) return;
    open(false);
    button.focus();
  };
  document.addEventListener('pointerdown', onOutside);
  document.addEventListener('keydown', onKey);
  const unsubscribe = scan.subscribe((state) => {
    node.hidden = state.phase !== 'finished' && state.phase !== 'interrupted';
  });
  return {
    element: node,
    dispose() {
      disposed = true;
      clearTimeout(timer);
      unsubscribe();
      document.removeEventListener('pointerdown', onOutside);
      document.removeEventListener('keydown', onKey);
    },
  };
}

// What was imported is taken as it came.
function isFinished(one: ScanExport): boolean {
  return one.kind === 'mesh' && one.format !== importedMesh;
}

const triangleChoices: readonly [string, Partial<MeshFinish>][] = [
  [t.all, {}],
  [t.fewerWithin1Mm, { simplify_um: 1_000 }],
  [t.farFewerWithin5Mm, { simplify_um: 5_000 }],
];
const holeChoices: readonly [string, Partial<MeshFinish>][] = [
  [t.leftOpen, {}],
  [t.filledUpTo15Cm, { fill_holes_mm: 150 }],
  [t.allClosedForPrinting, { fill_holes_mm: 150, close: true }],
];

function finishChoices(choose: (finish: MeshFinish) => void): HTMLElement {
  const selectOf = (all: readonly [string, Partial<MeshFinish>][]): HTMLSelectElement =>
    element('select', {}, ...all.map(([label], i) => element('option', { value: i }, label)));
  const triangles = selectOf(triangleChoices);
  const holes = selectOf(holeChoices);
  const tell = (): void =>
    choose({ ...asItIs, ...triangleChoices[triangles.selectedIndex]?.[1], ...holeChoices[holes.selectedIndex]?.[1] });
  for (const one of [triangles, holes]) one.addEventListener('change', tell);
  return element('div', { class: 'download-finish' }, element('label', {}, t.triangles, triangles), element('label', {}, t.holes, holes));
}

// "Kitchen-mesh.glb".
function downloadName(scan: LiveScan, file: string): string {
  return `${fileNameOf(scan.title) || scan.scanId}-${file}`;
}
