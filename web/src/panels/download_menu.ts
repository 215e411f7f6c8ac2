// Everything that a finished scan can be taken away as. What is not there yet is made by the server
// first; who has asked for it gets it when it is ready.
import { fileNameOf, saveAs } from '../connection/api';
import {
  fetchExport,
  fetchExports,
  removeExport,
  requestExport,
  type ScanExport,
} from '../connection/exports';
import { fetchAccess } from '../connection/scans';
import { Downloads, type ExportServer } from '../state/downloads';
import type { LiveScan } from '../state/live_scan';
import type { Store } from '../state/store';
import { exportText } from '../state/text';
import { t } from '../texts/texts';
import { buttonOf, element, type Panel } from './dom';
import { downloadList } from './download_list';
import { madeExports } from './made_exports';
import { noticeLine } from './notice';
import { popUp } from './pop_up';

export function downloadMenu(scan: Store<LiveScan, never>, token: string): Panel {
  const button = buttonOf(t.download, { 'aria-expanded': 'false', 'aria-controls': 'downloads' });
  const { element: notice, say } = noticeLine();
  const close = buttonOf(t.close, { class: 'button close', 'aria-label': t.closeTheDownloads });
  let mayRemove = false;
  let disposed = false;
  const show = (): void => {
    list.show(downloads.all);
    made.show(downloads.all, mayRemove);
  };
  const downloads = new Downloads(serverOf(scan.get().scanId, token), {
    show,
    say,
    save: (blob, { file }) => saveAs(blob, downloadName(scan.get(), file)),
    isLookedAt: () => menu.isOpen(),
  });
  const textOf = (one: ScanExport): string => exportText(one, downloads.loadedOf(one));
  const list = downloadList({ take: (one) => void downloads.take(one), textOf });
  const made = madeExports({
    take: (format) => void downloads.take(downloads.find(format)),
    remove: (format) => void downloads.remove(format),
    textOf,
  });
  const title = element('h2', {}, t.download);
  const looks = { id: 'downloads', class: 'card downloads', 'aria-label': t.downloads };
  const card = element('section', looks, title, close, notice, list.element, made.element);
  const node = element('div', { class: 'download' }, button, card);
  const opened = (): void => {
    if (downloads.all.length === 0) say(t.loadingNow);
    fetchAccess(token).then(
      (access) => {
        mayRemove = access.scan;
        if (!disposed) show();
      },
      () => {}, // what may not be removed cannot be known
    );
    downloads.look();
  };
  const menu = popUp({ node, button, card, close, opened });
  const unsubscribe = scan.subscribe((state) => {
    node.hidden = state.phase !== 'finished' && state.phase !== 'interrupted';
  });
  return {
    element: node,
    dispose() {
      disposed = true;
      downloads.dispose();
      menu.dispose();
      unsubscribe();
    },
  };
}

function serverOf(scanId: string, token: string): ExportServer {
  return {
    list: () => fetchExports(scanId, token),
    make: (format, finish) => requestExport(scanId, format, token, finish),
    remove: (format) => removeExport(scanId, format, token),
    load: (format, progress) => fetchExport(scanId, format, token, progress),
  };
}

// "Kitchen-mesh.glb".
function downloadName(scan: LiveScan, file: string): string {
  return `${fileNameOf(scan.title) || scan.scanId}-${file}`;
}
