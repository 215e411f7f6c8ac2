// Keeps the address of a scan's page that of what is seen.
import { hashOf } from './route';
import type { Store } from './store';

const addressAfter_ms = 400;

// `query`: how the scan is looked at just now. Browsers let the address change only so
// often. Returns how to stop.
export function watchAddress(
  scanId: string,
  query: () => string,
  stores: readonly Pick<Store<unknown, never>, 'subscribe'>[],
): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let before = query();
  const onChange = (): void => {
    clearTimeout(timer);
    timer = setTimeout(() => {
      const now = query();
      if (now !== before) history.replaceState(null, '', hashOf(scanId, now));
      before = now;
    }, addressAfter_ms);
  };
  const unsubscribers = stores.map((store) => store.subscribe(onChange));
  return () => {
    clearTimeout(timer);
    for (const unsubscribe of unsubscribers) unsubscribe();
  };
}
