// Starts the viewer: takes the token out of the address bar, then shows the page
// that the fragment names.
import { readFragment, storedToken, storeToken } from './connection/token';
import { comparePage, type ComparePage } from './panels/compare_page';
import type { Panel } from './panels/dom';
import { listPage } from './panels/list_page';
import { qualityPage, type QualityPage } from './panels/quality_page';
import { scanPage, type ScanPage } from './panels/scan_page';
import { routeOf } from './state/route';
import { language } from './texts/texts';
import { ofThisTab } from './state/storages';

document.documentElement.lang = language;
const app = document.getElementById('app')!;
let page: Panel | null = null;
let opened: ScanPage | QualityPage | null = null;
let compared: ComparePage | null = null;

function takeToken(): void {
  const fragment = readFragment(location.hash);
  if (fragment.token) storeToken(ofThisTab, fragment.token);
  if (fragment.hash !== location.hash) history.replaceState(null, '', fragment.hash);
}

function show(): void {
  takeToken();
  const route = routeOf(location.hash);
  page?.dispose();
  opened = compared = null;
  if (route.page === 'scan') {
    page = opened = scanPage(route.scanId, storedToken(ofThisTab), route.view);
  } else if (route.page === 'quality') {
    page = opened = qualityPage(route.scanId, storedToken(ofThisTab));
  } else if (route.page === 'compare') {
    page = compared = comparePage(route.scanId, route.other, storedToken(ofThisTab));
  } else {
    page = listPage({
      token: () => storedToken(ofThisTab),
      setToken: (token) => storeToken(ofThisTab, token),
    });
  }
  app.replaceChildren(page.element);
}

// For tests and the curious: what the page shows, to read only.
const seen = (): ScanPage | ComparePage | null =>
  compared ?? (opened && 'drawCalls' in opened ? opened : null);
const shown = {
  scan: () => opened?.scan.get() ?? null,
  drawCalls: () => seen()?.drawCalls() ?? 0,
  isResting: () => seen()?.isResting() ?? true,
};
Object.defineProperty(window, 'hermite', { value: Object.freeze(shown) });
window.addEventListener('hashchange', show);
show();
