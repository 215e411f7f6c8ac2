// Starts the viewer: takes the token out of the address bar, then shows the page that the fragment names.
import { readFragment, storedToken, storeToken } from './connection/token';
import type { Panel } from './panels/dom';
import { listPage } from './panels/list_page';
import { scanPage, type ScanPage } from './panels/scan_page';
import { routeOf } from './state/route';

const app = document.getElementById('app')!;
let page: Panel | null = null;
let opened: ScanPage | null = null;

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
    page = opened = scanPage(route.scanId, storedToken(sessionStorage), route.view);
  } else {
    opened = null;
    page = listPage({ token: () => storedToken(sessionStorage), setToken: (token) => storeToken(sessionStorage, token) });
  }
  app.replaceChildren(page.element);
}

// For tests and the curious: what the page shows, to read only.
const shown = { scan: () => opened?.scan.get() ?? null, drawCalls: () => opened?.drawCalls() ?? 0, isResting: () => opened?.isResting() ?? true };
Object.defineProperty(window, 'hermite', { value: Object.freeze(shown) });
window.addEventListener('hashchange', show);
show();
