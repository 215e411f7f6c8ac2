// The notes of one page: those that are there, the chosen one, and what somebody is writing. Pure.
import type { Place } from '../connection/measurements';
import type { Note, NoteView } from '../connection/notes';
import { t } from '../texts/texts';

export interface Draft {
  readonly of: Note | null; // the note that is changed, as it was read; null: it is a new one
  readonly position_m: Place; // in the world of the scan
  readonly view: NoteView | null;
  readonly text: string; // as it is written so far
  readonly theirs: Note | null; // what somebody else has made of it meanwhile: one has to choose
}

export interface Noting {
  readonly active: boolean; // the panel is open, and clicks mean notes
  readonly mayWrite: boolean;
  readonly notes: readonly Note[]; // oldest first
  readonly away: readonly string[]; // ids of those that were removed a moment ago
  readonly chosen: string | null; // an id; it may not be in the list yet
  readonly draft: Draft | null; // it stays when the panel is closed
  readonly busy: boolean; // the draft is on its way to the server
  readonly problem: string; // for people, or empty
  readonly unlisted: string; // why the list did not come the last time, or empty
}

export const initialNoting: Noting = {
  active: false,
  mayWrite: false,
  notes: [],
  away: [],
  chosen: null,
  draft: null,
  busy: false,
  problem: '',
  unlisted: '',
};

export type NotingEvent =
  | { readonly kind: 'active'; readonly active: boolean }
  | { readonly kind: 'access'; readonly mayWrite: boolean }
  | { readonly kind: 'listed'; readonly notes: readonly Note[] }
  | { readonly kind: 'away'; readonly ids: readonly string[] }
  | { readonly kind: 'chosen'; readonly id: string | null }
  // A click on the model; null: nothing was there.
  | { readonly kind: 'placed'; readonly position_m: Place | null; readonly view: NoteView }
  | { readonly kind: 'edited' } // the chosen one is to be changed
  | { readonly kind: 'typed'; readonly text: string }
  | { readonly kind: 'cancelled' }
  | { readonly kind: 'saving' }
  | { readonly kind: 'saved'; readonly note: Note }
  | { readonly kind: 'conflict'; readonly now: Note }
  | { readonly kind: 'gone' } // somebody has removed the note that is changed
  | { readonly kind: 'resolved'; readonly keep: 'mine' | 'theirs' | 'both' }
  | { readonly kind: 'failed'; readonly message: string } // the draft was not saved
  | { readonly kind: 'refused'; readonly message: string } // something else does not work
  | { readonly kind: 'unlisted'; readonly message: string };

const unsavedText = t.saveTheNoteOrCancelIts;
const choiceText = t.whichTextIsToStay;
const samePlace_m = 1e-4; // two clicks are farther apart, the same place comes back nearer
const mostText_bytes = 2000; // the server takes no more

export function reduceNoting(state: Noting, event: NotingEvent): Noting {
  switch (event.kind) {
    case 'active':
      return {
        ...state,
        active: event.active,
        chosen: event.active ? state.chosen : null,
        problem: '',
      };
    case 'access':
      return { ...state, mayWrite: event.mayWrite };
    case 'listed':
      return listed(state, event.notes);
    case 'away':
      return {
        ...state,
        away: event.ids,
        chosen: event.ids.includes(state.chosen ?? '') ? null : state.chosen,
      };
    case 'chosen':
      return { ...state, chosen: event.id, problem: '' };
    case 'placed':
      return placed(state, event.position_m, event.view);
    case 'edited':
      return edited(state);
    case 'typed':
      return state.draft
        ? { ...state, draft: { ...state.draft, text: event.text }, problem: '' }
        : state;
    case 'cancelled':
      return state.busy ? state : { ...state, draft: null, problem: '' };
    case 'saving':
      return saving(state);
    case 'saved':
      return {
        ...state,
        notes: withNote(state.notes, event.note),
        chosen: event.note.id,
        draft: null,
        busy: false,
        problem: '',
      };
    case 'failed':
      return { ...state, busy: false, problem: event.message };
    case 'refused':
      return { ...state, problem: event.message };
    case 'unlisted':
      return event.message === state.unlisted ? state : { ...state, unlisted: event.message };
    default:
      return collided(state, event);
  }
}

// What comes of a note that somebody else has changed or removed while it was changed here.
function collided(
  state: Noting,
  event: NotingEvent & { readonly kind: 'conflict' | 'gone' | 'resolved' },
): Noting {
  const { draft, notes } = state;
  if (!draft?.of) return state;
  if (event.kind === 'conflict')
    return {
      ...state,
      notes: withNote(notes, event.now),
      draft: { ...draft, theirs: event.now },
      busy: false,
      problem: '',
    };
  if (event.kind === 'resolved')
    return draft.theirs ? resolved(state, { ...draft, theirs: draft.theirs }, event.keep) : state;
  const problem = t.somebodyHasRemovedThisNoteMeanwhile;
  const others = notes.filter(({ id }) => id !== draft.of?.id);
  return {
    ...state,
    notes: others,
    chosen: null,
    draft: { ...draft, of: null, theirs: null },
    busy: false,
    problem,
  };
}

// Both texts are one note if there is room for them, else two.
function resolved(
  state: Noting,
  draft: Draft & { readonly theirs: Note },
  keep: 'mine' | 'theirs' | 'both',
): Noting {
  if (keep === 'theirs') return { ...state, draft: null, problem: '' };
  if (keep === 'mine') return { ...state, draft: { ...draft, of: draft.theirs, theirs: null } };
  const text = `${draft.theirs.text}\n\n${cleaned(draft.text)}`;
  const fits = bytesOf(text) <= mostText_bytes;
  return {
    ...state,
    draft: {
      ...draft,
      of: fits ? draft.theirs : null,
      text: fits ? text : draft.text,
      theirs: null,
    },
  };
}

// The same again changes nothing, so that the page need not show it again.
function listed(state: Noting, notes: readonly Note[]): Noting {
  const chosenIsGone = state.chosen !== null && !notes.some(({ id }) => id === state.chosen);
  const same = JSON.stringify(notes) === JSON.stringify(state.notes);
  const written = state.busy ? undefined : notes.find((note) => isWritten(state.draft, note));
  if (same && !chosenIsGone && !written && state.unlisted === '') return state;
  const gone = chosenIsGone ? { chosen: null, problem: t.thisNoteDoesNotExistOr } : {};
  const done = written ? { chosen: written.id, draft: null, problem: '' } : {};
  return { ...state, notes: same ? state.notes : notes, unlisted: '', ...gone, ...done };
}

// Whether the draft was saved after all: its answer was lost, or the page was left before it came.
function isWritten(draft: Draft | null, note: Note): boolean {
  if (!draft || draft.theirs || !isUnsaved(draft) || cleaned(draft.text) !== note.text)
    return false;
  if (draft.of) return draft.of.id === note.id;
  return draft.position_m.every(
    (value, axis) => Math.abs(value - note.position_m[axis]!) < samePlace_m,
  );
}

function placed(state: Noting, position_m: Place | null, view: NoteView): Noting {
  if (!state.active || !state.mayWrite || state.busy) return state;
  if (!position_m) return { ...state, problem: t.thereIsNothingClickOnA };
  if (state.draft?.of) return { ...state, problem: heldText(state.draft) || unsavedText };
  return {
    ...state,
    chosen: null,
    draft: { of: null, position_m, view, text: state.draft?.text ?? '', theirs: null },
    problem: '',
  };
}

function edited(state: Noting): Noting {
  const note = chosenNote(state);
  if (!note || !state.mayWrite || state.draft) return state;
  return {
    ...state,
    draft: {
      of: note,
      position_m: note.position_m,
      view: note.view,
      text: note.text,
      theirs: null,
    },
    problem: '',
  };
}

function saving(state: Noting): Noting {
  if (!state.draft || state.draft.theirs || state.busy) return state;
  const problem = textProblem(state.draft.text);
  return problem === '' ? { ...state, busy: true, problem: '' } : { ...state, problem };
}

function withNote(notes: readonly Note[], note: Note): readonly Note[] {
  return notes.some(({ id }) => id === note.id)
    ? notes.map((one) => (one.id === note.id ? note : one))
    : [...notes, note];
}

// Those that are to be seen; their numbers count from 1.
export function shownNotes({ notes, away }: Pick<Noting, 'notes' | 'away'>): readonly Note[] {
  return away.length === 0 ? notes : notes.filter(({ id }) => !away.includes(id));
}

export function chosenNote(state: Noting): Note | null {
  return shownNotes(state).find(({ id }) => id === state.chosen) ?? null;
}

// Whether text would be lost with it.
export function isUnsaved(draft: Draft | null): boolean {
  return draft !== null && cleaned(draft.text) !== (draft.of?.text ?? '');
}

// What has to be done before somebody goes on to something else; empty: nothing would be lost.
export function heldText(draft: Draft | null): string {
  if (draft?.theirs) return choiceText;
  return isUnsaved(draft) ? unsavedText : '';
}

// As the server takes it: line breaks are the only control characters, and there
// is no half of a character.
export function cleaned(text: string): string {
  return text
    .replace(/\r\n?/g, '\n')
    .replaceAll('\t', ' ')
    .replace(/[\u0000-\u0009\u000b-\u001f\u007f-\u009f]|\p{Cs}/gu, '')
    .trim();
}

// Empty: it can be saved.
export function textProblem(text: string): string {
  const bytes = bytesOf(cleaned(text));
  if (bytes === 0) return t.aNoteHasAtLeastOne;
  return bytes > mostText_bytes ? t.thisHasBytesAllowedAre(bytes, mostText_bytes) : '';
}

// What the page asks for now.
export function notingText(state: Noting): string {
  const { draft, problem, unlisted, busy, mayWrite } = state;
  if (problem !== '' || unlisted !== '') return problem || unlisted;
  if (busy) return t.saving;
  if (draft?.theirs) return choiceText;
  if (draft?.of) return t.changeTheText;
  if (draft) return t.whatIsThereAnotherClickMoves;
  if (mayWrite) return t.clickOnTheModelToWrite;
  return shownNotes(state).length === 0 ? t.thereAreNoNotes : t.chooseANoteToSeeIt;
}

function bytesOf(text: string): number {
  return new TextEncoder().encode(text).length;
}
