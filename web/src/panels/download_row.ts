// One line of the downloads: what it is, and how far the server is with it.
import type { ScanExport } from '../connection/exports';
import { sizeText } from '../state/text';
import { element, setText } from './dom';

export interface DownloadRow {
  readonly element: HTMLButtonElement;
  show(one: ScanExport): void;
}

export function downloadRow(
  label: string,
  choose: () => void,
  textOf: (one: ScanExport) => string,
): DownloadRow {
  const state = element('span', { class: 'download-state' });
  const node = element(
    'button',
    { type: 'button', class: 'download-row' },
    element('span', {}, label),
    state,
  );
  node.addEventListener('click', choose);
  return {
    element: node,
    show(one) {
      node.dataset['state'] = one.state;
      setText(state, textOf(one));
      node.title = one.state === 'ready' ? `${one.file}, ${sizeText(one.size_bytes)}` : one.words;
    },
  };
}
