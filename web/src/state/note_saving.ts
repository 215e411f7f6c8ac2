// How what somebody has written comes to the server: once, however often it is asked for.
import { errorText } from '../connection/api';
import type { NewNote, Note, NoteChange } from '../connection/notes';
import { cleaned, type Noting, type NotingEvent } from './noting';
import type { Store } from './store';

export interface NoteServer {
  create(note: NewNote): Promise<Note>;
  change(note: Note, text: string): Promise<NoteChange>;
}

// Nothing happens while an earlier saving is on its way.
export function saveDraft(
  store: Pick<Store<Noting, NotingEvent>, 'get' | 'dispatch'>,
  server: NoteServer,
): void {
  if (store.get().busy) return;
  store.dispatch({ kind: 'saving' });
  const { draft, busy } = store.get();
  if (!draft || !busy) return; // the text is none that can be saved
  const text = cleaned(draft.text);
  const saved = (note: Note): void => store.dispatch({ kind: 'saved', note });
  const fail = (error: unknown): void =>
    store.dispatch({ kind: 'failed', message: errorText(error) });
  if (!draft.of) {
    server.create({ position_m: draft.position_m, view: draft.view, text }).then(saved, fail);
    return;
  }
  server.change(draft.of, text).then((change) => {
    if (change.kind === 'done') saved(change.note);
    else store.dispatch(change);
  }, fail);
}
