// How somebody looks at one scan: begins as the address, the tab and the browser remember it, and
// can be told as an address again.
import { cutQuery, readCut } from './cut_link';
import { reduceCutting, type Cutting, type CuttingEvent } from './cutting';
import { storedDraft } from './note_drafts';
import { noteQuery, readNote } from './note_link';
import { initialNoting, reduceNoting, type Noting, type NotingEvent } from './noting';
import type { SomeStorage } from './storages';
import { createStore, type Store } from './store';
import {
  initialViewOptions,
  reduceViewOptions,
  storedShow,
  type ViewOptions,
} from './view_options';

export interface Looking {
  readonly options: Store<ViewOptions, Partial<ViewOptions>>;
  readonly cutting: Store<Cutting, CuttingEvent>;
  readonly noting: Store<Noting, NotingEvent>;
  query(): string; // the fields of an address that opens the same view
}

interface Memory {
  readonly view: string; // the fields of the address
  readonly browser: SomeStorage;
  readonly tab: SomeStorage;
}

export function beginLooking(scanId: string, { view, browser, tab }: Memory): Looking {
  const options = createStore<ViewOptions, Partial<ViewOptions>>(
    { ...initialViewOptions, show: storedShow(browser) },
    reduceViewOptions,
  );
  const cutting = createStore<Cutting, CuttingEvent>(readCut(view), reduceCutting);
  const remembered: Noting = {
    ...initialNoting,
    chosen: readNote(view),
    draft: storedDraft(tab, scanId),
  };
  const noting = createStore<Noting, NotingEvent>(remembered, reduceNoting);
  return {
    options,
    cutting,
    noting,
    query: () =>
      [cutQuery(cutting.get()), noteQuery(noting.get().chosen)].filter(Boolean).join('&'),
  };
}
