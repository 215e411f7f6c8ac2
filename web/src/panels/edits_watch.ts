// The edits of a scan that has ended: read when it has, and when the page is looked at again; shown
// in the scene; changed step by step.
import { errorText } from '../connection/api';
import { fetchEdits, saveEdits } from '../connection/edits';
import { patiently } from '../connection/patience';
import type { ScanScene } from '../scene/scene';
import {
  added,
  boxEdits,
  initialEditing,
  redoneOnce,
  reduceEditing,
  undoneOnce,
  type Edit,
  type Editing,
  type EditStep,
} from '../state/editing';
import type { LiveScan } from '../state/live_scan';
import { createStore, type Store } from '../state/store';
import { t } from '../texts/texts';

export interface EditsWatch {
  readonly store: Pick<Store<Editing, never>, 'get' | 'subscribe'>;
  areThereAny(): Promise<boolean>; // once the server has told, or cannot
  make(edit: Edit): void;
  undo(): void;
  redo(): void;
  dispose(): void;
}

interface World {
  readonly scan: Store<LiveScan, never>;
  readonly scene: Pick<ScanScene, 'showEdits'>;
  readonly token: string;
  readonly changed: () => void; // the surface is made anew
}

export function watchEdits({ scan, scene, token, changed }: World): EditsWatch {
  const { scanId } = scan.get();
  const store = createStore(initialEditing, reduceEditing);
  const stopped = new AbortController();
  let shown: readonly Edit[] = initialEditing.edits;
  let reading: Promise<void> | null = null;
  const read = async (): Promise<void> => {
    const list = await patiently(() => fetchEdits(scanId, token), stopped.signal);
    const { known, version, busy } = store.get();
    if (stopped.signal.aborted || busy || (known && list.version === version)) return;
    store.dispatch({ kind: 'read', list });
    if (known) changed();
  };
  const save = async (step: EditStep | null): Promise<void> => {
    const { known, busy, version } = store.get();
    if (!known || busy) return;
    if (!step) return store.dispatch({ kind: 'failed', message: t.thereAreAsManyEditsAs });
    store.dispatch({ kind: 'saving' });
    try {
      const { kind, now } = await saveEdits(scanId, token, { version, edits: step.edits });
      store.dispatch(
        kind === 'done' ? { kind: 'saved', list: now, undone: step.undone } : { kind, now },
      );
      changed();
    } catch (error) {
      store.dispatch({ kind: 'failed', message: errorText(error) });
    }
  };
  const onSeen = (): void => {
    if (document.visibilityState === 'visible' && store.get().known) void read().catch(() => {});
  };
  document.addEventListener('visibilitychange', onSeen);
  const unsubscribers = [
    store.subscribe(({ edits }) => {
      if (edits === shown) return;
      shown = edits;
      scene.showEdits(boxEdits(edits));
    }),
    scan.subscribe(({ phase }) => {
      // When the edits cannot be read, there is nothing to edit.
      if (phase === 'finished' || phase === 'interrupted') reading ??= read().catch(() => {});
    }),
  ];
  return {
    store,
    async areThereAny() {
      await reading;
      return store.get().edits.length > 0;
    },
    make: (edit) => void save(added(store.get(), edit)),
    undo: () => void save(undoneOnce(store.get())),
    redo: () => void save(redoneOnce(store.get())),
    dispose() {
      stopped.abort();
      document.removeEventListener('visibilitychange', onSeen);
      for (const unsubscribe of unsubscribers) unsubscribe();
    },
  };
}
