// Notes: pins with text at places of the model. What others write meanwhile comes when the page is
// looked at again, and now and then.
import { ApiError, errorText } from '../connection/api';
import {
  changeNote,
  createNote,
  fetchNotes,
  removeNote,
  type Note,
  type NoteChange,
} from '../connection/notes';
import { fetchAccess } from '../connection/scans';
import { pinAt, type NotePin } from '../scene/note_layer';
import type { ScanScene } from '../scene/scene';
import { hasEnded, type LiveScan } from '../state/live_scan';
import { storeDraft } from '../state/note_drafts';
import { saveDraft, type NoteServer } from '../state/note_saving';
import {
  chosenNote,
  cleaned,
  heldText,
  isUnsaved,
  shownNotes,
  type Draft,
  type Noting,
  type NotingEvent,
} from '../state/noting';
import type { Store } from '../state/store';
import { Trash } from '../state/trash';
import { t } from '../texts/texts';
import type { Panel } from './dom';
import { notesView, numberOf } from './notes_view';
import { onTap } from './tap';
import { ofThisTab } from '../state/storages';

export interface NotesPanel extends Panel {
  readonly button: HTMLElement; // opens and closes it; hidden where there is nothing to write on
  toggle(): void; // the same
  close(): void;
}

type NotingStore = Store<Noting, NotingEvent>;

interface World {
  readonly canvas: HTMLCanvasElement;
  readonly scene: ScanScene;
  readonly scan: Store<LiveScan, never>;
  readonly store: NotingStore;
  readonly token: string;
  readonly opened: () => void; // it stands where others may stand
}

const fetchEvery_ms = 20_000; // while it is open and the page is seen
const meanwhile = t.changedAndNotRemoved;

// A note that the store begins with is opened as soon as it is there.
export function notesPanel({ canvas, scene, scan, store, token, opened }: World): NotesPanel {
  const { scanId } = scan.get();
  const list = listing(scanId, token, store);
  const removal = removing(scanId, token, store, list);
  const save = (): void => saveDraft(store, serverOf(scanId, token));
  const open = (active: boolean): void => {
    if (active === store.get().active) return;
    const hadFocus = view.node.contains(document.activeElement);
    if (active) opened();
    store.dispatch({ kind: 'active', active });
    if (active) void Promise.all([list(), askAccess(token, store)]);
    else if (hadFocus) view.button.focus();
  };
  const choose = (id: string | null): void => {
    store.dispatch({ kind: 'chosen', id });
    flyTo(scene, chosenNote(store.get()));
  };
  const view = notesView({
    choose,
    save,
    edit() {
      store.dispatch({ kind: 'edited' });
      view.focusText();
    },
    remove: removal.remove,
    type: (text) => store.dispatch({ kind: 'typed', text }),
    cancel: () => store.dispatch({ kind: 'cancelled' }),
    resolve(keep) {
      store.dispatch({ kind: 'resolved', keep });
      if (keep !== 'theirs') save();
    },
    undo: removal.undo,
    close: () => open(false),
  });
  const toggle = (): void => {
    if (!view.button.hidden) open(!store.get().active);
  };
  const show = (state: Noting): void => {
    canvas.classList.toggle('picking-notes', state.active && state.mayWrite);
    view.node.parentElement?.classList.toggle('noting', state.active);
    view.show(state, removal.newest());
    scene.showNotes(pinsOf(state));
  };
  onTap(canvas, (x_px, y_px) =>
    tapped([x_px, y_px], scene, store, { choose, begun: view.focusText }),
  );
  view.button.addEventListener('click', toggle);
  const look = (): void => void (store.get().active && list());
  const stops = [
    store.subscribe(show),
    keepingText(scanId, store),
    whenSeen(look),
    onEscape(store, () => open(false)),
  ];
  stops.push(
    whenThere({ scan, store, button: view.button, list, open }, () => choose(store.get().chosen)),
  );
  return {
    element: view.node,
    button: view.button,
    toggle,
    close: () => open(false),
    dispose() {
      for (const stop of stops) stop();
      removal.dispose();
    },
  };
}

interface Tapping {
  readonly choose: (id: string) => void;
  readonly begun: () => void; // somebody writes there now
}

// A pin that was clicked is chosen; elsewhere a new note begins.
function tapped(
  at_px: readonly [number, number],
  scene: ScanScene,
  store: NotingStore,
  { choose, begun }: Tapping,
): boolean {
  const state = store.get();
  if (!state.active) return false;
  const pin = pinAt(pinsOf(state), at_px, (place) => scene.screenOf(place));
  const note = pin === null ? undefined : shownNotes(state)[pin];
  if (note) {
    choose(note.id);
    return true;
  }
  store.dispatch({ kind: 'placed', position_m: scene.placeAt(...at_px), view: scene.view });
  if (store.get().draft !== state.draft) begun();
  return true;
}

function flyTo(scene: ScanScene, note: Note | null): void {
  if (note?.view) scene.lookAs(note.view);
  else if (note) scene.lookAt(note.position_m);
}

// In the order of the list, and the one that is written as the last.
function pinsOf(state: Noting): NotePin[] {
  if (!state.active) return [];
  const { draft, chosen } = state;
  const pins = shownNotes(state).map(({ id, position_m, text }, i) => ({
    position_m,
    number: i + 1,
    text: id === chosen ? text : '',
  }));
  if (!draft || draft.of) return pins;
  return [
    ...pins,
    {
      position_m: draft.position_m,
      number: numberOf(draft, state),
      text: cleaned(draft.text) || t.newNote,
    },
  ];
}

const serverOf = (scanId: string, token: string): NoteServer => ({
  create: (note) => createNote(scanId, token, note),
  change: (note, text) => changeNote(scanId, token, note, text),
});

// At each opening: an answer that was lost comes the next time.
function askAccess(token: string, store: NotingStore): Promise<void> {
  return fetchAccess(token).then(
    ({ view, scan }) => store.dispatch({ kind: 'access', mayWrite: view && scan }),
    (error) => store.dispatch({ kind: 'refused', message: errorText(error) }),
  );
}

// A list that was asked for before something was changed here is out of date.
function listing(scanId: string, token: string, store: NotingStore): () => Promise<void> {
  return () => {
    const { notes: before } = store.get();
    return fetchNotes(scanId, token).then(
      (notes) => {
        if (store.get().notes === before && !store.get().busy)
          store.dispatch({ kind: 'listed', notes });
      },
      (error) => store.dispatch({ kind: 'unlisted', message: errorText(error) }),
    );
  };
}

// What was removed can be taken back for some seconds; the server is told then.
function removing(scanId: string, token: string, store: NotingStore, list: () => Promise<void>) {
  const notes = new Map<string, { readonly note: Note; readonly number: number }>();
  const told = ({ kind }: NoteChange): void => {
    if (kind === 'conflict') throw new ApiError(meanwhile, false);
  };
  const trash = new Trash(
    {
      delete: (id, leaving) => removeNote(scanId, token, notes.get(id)!.note, leaving).then(told),
      after(delay_ms, action) {
        const timer = setTimeout(action, delay_ms);
        return () => clearTimeout(timer);
      },
    },
    () => store.dispatch({ kind: 'away', ids: [...notes.keys()].filter((id) => trash.has(id)) }),
    (_, error) =>
      void list().then(() => store.dispatch({ kind: 'refused', message: errorText(error) })),
  );
  const onLeave = (): void => trash.emptyAll();
  addEventListener('pagehide', onLeave);
  return {
    remove(note: Note, number: number): void {
      notes.set(note.id, { note, number });
      trash.put({ id: note.id, title: note.text });
    },
    undo: () => trash.newest && trash.undo(trash.newest.id),
    newest: () => (trash.newest ? notes.get(trash.newest.id)!.number : null),
    dispose() {
      removeEventListener('pagehide', onLeave);
      trash.emptyAll();
    },
  };
}

// Whenever somebody comes back to the page, and now and then while it is seen. Returns how to stop.
function whenSeen(look: () => void): () => void {
  const lookIfSeen = (): void => {
    if (document.visibilityState === 'visible') look();
  };
  const timer = setInterval(lookIfSeen, fetchEvery_ms);
  addEventListener('focus', lookIfSeen);
  document.addEventListener('visibilitychange', lookIfSeen);
  return () => {
    clearInterval(timer);
    removeEventListener('focus', lookIfSeen);
    document.removeEventListener('visibilitychange', lookIfSeen);
  };
}

// What is written is kept in this tab, and whoever closes or reloads the page before it is saved is
// asked. Returns how to stop.
function keepingText(scanId: string, store: NotingStore): () => void {
  let kept: Draft | null = null;
  const ask = (event: BeforeUnloadEvent): void => event.preventDefault();
  const unsubscribe = store.subscribe(({ draft }) => {
    if (draft === kept) return;
    kept = draft;
    storeDraft(ofThisTab, scanId, draft);
    if (isUnsaved(draft)) addEventListener('beforeunload', ask);
    else removeEventListener('beforeunload', ask); // a page that may ask comes back more slowly
  });
  return () => {
    unsubscribe();
    removeEventListener('beforeunload', ask);
  };
}

// First what is written, unless text would be lost with it, then the choice, then the panel.
function onEscape(store: NotingStore, close: () => void): () => void {
  const onKey = (event: KeyboardEvent): void => {
    const { active, draft, chosen, busy } = store.get();
    if (
      event.key !== 'Escape' ||
      !active ||
      busy ||
      event.defaultPrevented ||
      document.querySelector('dialog')
    )
      return;
    const message = heldText(draft);
    if (message !== '') store.dispatch({ kind: 'refused', message });
    else if (draft) store.dispatch({ kind: 'cancelled' });
    else if (chosen) store.dispatch({ kind: 'chosen', id: null });
    else close();
  };
  document.addEventListener('keydown', onKey);
  return () => document.removeEventListener('keydown', onKey);
}

interface Beginning {
  readonly scan: Store<LiveScan, never>;
  readonly store: NotingStore;
  readonly button: HTMLElement;
  readonly list: () => Promise<void>;
  readonly open: (active: boolean) => void;
}

// Shows the button once the scan has ended and there is something to write on, with the
// number of notes. What was not saved when the page was left is there again. `show`: the note
// of the address is there.
function whenThere({ scan, store, button, list, open }: Beginning, show: () => void): () => void {
  let asked = false;
  button.hidden = true;
  return scan.subscribe(({ phase, points, mesh }) => {
    button.hidden = !hasEnded(phase) || (points === 0 && mesh.state !== 'shown');
    if (button.hidden || asked) return;
    asked = true;
    const linked = store.get().chosen !== null;
    if (linked || store.get().draft) open(true);
    void list().then(() => linked && store.get().chosen && show());
  });
}
