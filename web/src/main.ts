// Starts the viewer: takes the token out of the address bar, then shows the page that the fragment names.
import { readFragment, storedToken, storeToken } from './connection/token';
import type { Panel } from './panels/dom';
import { listPage } from './panels/list_page';
import { scanPage } from './panels/scan_page';
import type { LiveScan } from './state/live_scan';
import { routeOf } from './state/route';

const app = document.getElementById('app')!;
let page: Panel | null = null;
let scan: (() => LiveScan) | null = null;
let drawCalls = (): number => 0;

function takeToken(): void {
  const fragment = readFragment(location.hash);
  if (fragment.token) storeToken(sessionStorage, fragment.token);
  if (fragment.hash !== location.hash) history.replaceState(null, '', fragment.hash);
}

function show(): void {
  takeToken();
  const route = routeOf(location.hash);
  page?.dispose();
  if (route.page === 'scan') {
    const opened = scanPage(route.scanId, storedToken(sessionStorage));
    scan = () => opened.scan.get();
    drawCalls = opened.drawCalls;
    page = opened;
  } else {
    scan = null;
    page = listPage({ token: () => storedToken(sessionStorage), setToken: (token) => storeToken(sessionStorage, token) });
  }
  app.replaceChildren(page.element);
}

// For tests and the curious: what the page shows, to read only.
Object.defineProperty(window, 'hermite', { value: Object.freeze({ scan: () => scan?.() ?? null, drawCalls: () => drawCalls() }) });
window.addEventListener('hashchange', show);
show();
