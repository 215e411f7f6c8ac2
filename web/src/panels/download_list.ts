// A row for each format by its kind; of a mesh it says how far that is which has the chosen finish.
import {
  asItIs,
  finishedAs,
  importedMesh,
  isMade,
  type MeshFinish,
  type ScanExport,
} from '../connection/exports';
import { kindText } from '../state/text';
import { t } from '../texts/texts';
import { element } from './dom';
import { downloadRow, type DownloadRow } from './download_row';

export interface DownloadList {
  readonly element: HTMLElement;
  show(all: readonly ScanExport[]): void;
}

interface Choices {
  take(one: ScanExport): void;
  textOf(one: ScanExport): string;
}

export function downloadList({ take, textOf }: Choices): DownloadList {
  const node = element('div', { class: 'download-list' });
  const rows = new Map<string, DownloadRow>();
  let exports: readonly ScanExport[] = [];
  let finish = asItIs; // of meshes
  const formats = (): ScanExport[] => exports.filter((one) => !isMade(one));
  const chosen = (one: ScanExport): ScanExport =>
    isFinished(one) ? finishedAs(exports, one, finish) : one;
  const refresh = (): void => {
    if (formats().some((one) => !rows.has(one.format))) build();
    for (const one of formats()) rows.get(one.format)?.show(chosen(one));
  };
  const choices = finishChoices((now) => {
    finish = now;
    refresh();
  });
  const addRow = ({ format, label }: ScanExport): DownloadRow => {
    const takeChosen = (): void => {
      const plain = exports.find((one) => one.format === format);
      if (plain) take(chosen(plain));
    };
    const row = downloadRow(label, takeChosen, textOf);
    rows.set(format, row);
    return row;
  };
  const build = (): void => {
    rows.clear();
    const kinds = [...new Set(formats().map((one) => one.kind))];
    node.replaceChildren(
      ...kinds.map((kind) => {
        const ofKind = formats().filter((one) => one.kind === kind);
        const finishes = ofKind.some(isFinished) ? choices : null;
        return element(
          'div',
          { class: 'download-kind' },
          element('h3', {}, kindText(kind)),
          finishes,
          ...ofKind.map((one) => addRow(one).element),
        );
      }),
    );
  };
  return {
    element: node,
    show(all) {
      exports = all;
      refresh();
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
    choose({
      ...asItIs,
      ...triangleChoices[triangles.selectedIndex]?.[1],
      ...holeChoices[holes.selectedIndex]?.[1],
    });
  for (const one of [triangles, holes]) one.addEventListener('change', tell);
  return element(
    'div',
    { class: 'download-finish' },
    element('label', {}, t.triangles, triangles),
    element('label', {}, t.holes, holes),
  );
}
