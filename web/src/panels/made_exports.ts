// The exports of a scan that were made with options. The server keeps a limited number of them, so
// each can be removed here.
import { isMade, type ScanExport } from '../connection/exports';
import { finishText } from '../state/text';
import { t } from '../texts/texts';
import { buttonOf, element } from './dom';
import { downloadRow, type DownloadRow } from './download_row';

export interface MadeExports {
  readonly element: HTMLElement;
  show(all: readonly ScanExport[], mayRemove: boolean): void;
}

interface Choices {
  take(format: string): void;
  remove(format: string): void;
  textOf(one: ScanExport): string;
}

export function madeExports({ take, remove, textOf }: Choices): MadeExports {
  const list = element('div');
  const node = element(
    'div',
    { class: 'download-kind' },
    element('h3', {}, t.madeWithOptions),
    list,
  );
  const rows = new Map<
    string,
    { readonly line: HTMLElement; readonly row: DownloadRow; readonly button: HTMLElement }
  >();
  const add = (one: ScanExport): void => {
    const label = `${one.label}: ${finishText(one.finish)}`;
    const row = downloadRow(label, () => take(one.format), textOf);
    const button = buttonOf(t.remove, {
      class: 'button download-remove',
      'aria-label': t.removeNamed(label),
    });
    button.addEventListener('click', () => remove(one.format));
    const line = element('div', { class: 'download-made' }, row.element, button);
    rows.set(one.format, { line, row, button });
    list.append(line);
  };
  return {
    element: node,
    show(all, mayRemove) {
      const made = all.filter(isMade);
      node.hidden = made.length === 0;
      for (const [format, { line }] of rows) {
        if (made.some((one) => one.format === format)) continue;
        line.remove();
        rows.delete(format);
      }
      for (const one of made) {
        if (!rows.has(one.format)) add(one);
        const { row, button } = rows.get(one.format)!;
        row.show(one);
        button.hidden = !mayRemove;
      }
    },
  };
}
