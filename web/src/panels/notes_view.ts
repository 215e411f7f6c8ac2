// What the panel of notes is made of: the text that somebody writes, two texts
// to choose from, the list.
import type { Note } from '../connection/notes';
import { chosenNote, notingText, shownNotes, type Draft, type Noting } from '../state/noting';
import { locale, t } from '../texts/texts';
import { buttonOf, element, setText } from './dom';

export interface NoteActions {
  choose(id: string | null): void;
  edit(): void;
  remove(note: Note, number: number): void;
  type(text: string): void;
  save(): void;
  cancel(): void;
  resolve(keep: 'mine' | 'theirs' | 'both'): void;
  undo(): void;
  close(): void;
}

const act = (label: string, title: string, run: () => void, primary = false): HTMLButtonElement => {
  const button = buttonOf(label, { class: primary ? 'button primary' : 'button', title });
  button.addEventListener('click', run);
  return button;
};

export function notesView(actions: NoteActions) {
  const title = t.notesAtPlacesOfTheModel;
  const button = buttonOf(t.notes, {
    class: 'button notes-button',
    title,
    'aria-pressed': 'false',
  });
  const prompt = element('p', { class: 'notes-words', role: 'status' });
  const writing = writingView(actions);
  const list = listView(actions);
  const removed = element('span');
  const undo = element(
    'div',
    { class: 'notes-removed' },
    removed,
    act(t.undo, t.takesTheRemovalBack, () => actions.undo()),
  );
  const done = act(t.close, t.closesTheNotesEscape, () => actions.close());
  const foot = element('div', { class: 'buttons panel-foot' }, done);
  const node = element(
    'section',
    { class: 'card notes', 'aria-label': t.notes },
    prompt,
    writing.node,
    list.node,
    undo,
    foot,
  );
  // `removedNumber`: of the note that was removed a moment ago; null: none was.
  const show = (state: Noting, removedNumber: number | null): void => {
    const count = shownNotes(state).length;
    node.hidden = !state.active;
    setText(button, count === 0 ? t.notes : t.notesCount(count));
    button.setAttribute('aria-pressed', String(state.active));
    setText(prompt, notingText(state));
    const { activeElement } = document;
    const isFree = activeElement === document.body || writing.node.contains(activeElement);
    const ends = state.active && !state.draft && !writing.node.hidden && isFree;
    writing.show(state);
    list.show(state);
    // What had the focus is hidden now.
    if (ends) (list.node.querySelector<HTMLElement>('[aria-current]') ?? done).focus();
    undo.hidden = removedNumber === null;
    setText(removed, removedNumber === null ? '' : t.noteIsRemoved(removedNumber));
  };
  return { node, button, show, focusText: writing.focus };
}

function writingView(actions: NoteActions) {
  const label = element('label', { for: 'note-text' });
  const text = element('textarea', {
    id: 'note-text',
    rows: 4,
    'aria-describedby': 'note-readers',
  });
  const theirs = element('p', { class: 'note-whole' });
  const both = element(
    'div',
    { class: 'notes-conflict' },
    element('p', { class: 'notes-small' }, t.theTextOfSomebodyElse),
    theirs,
  );
  const save = act(t.save, t.savesTheTextCtrlAndEnter, () => actions.save(), true);
  const cancel = act(t.cancel, t.keepsNothingOfWhatIsWritten, () => actions.cancel());
  const saving = element('div', { class: 'buttons' }, save, cancel);
  const choosing = element(
    'div',
    { class: 'buttons notes-choice' },
    act(t.keepMine, t.yourTextReplacesTheOtherOne, () => actions.resolve('mine')),
    act(t.keepTheirs, t.yourTextIsThrownAway, () => actions.resolve('theirs')),
    act(t.keepBoth, t.oneAfterTheOtherAsTwo, () => actions.resolve('both')),
  );
  const readers = element(
    'p',
    { class: 'notes-small', id: 'note-readers' },
    t.everybodyWhoSeesThisScanCan,
  );
  const node = element(
    'div',
    { class: 'notes-writing' },
    both,
    label,
    text,
    readers,
    saving,
    choosing,
  );
  node.hidden = true;
  text.addEventListener('input', () => actions.type(text.value));
  text.addEventListener('keydown', (event) => {
    if (event.key !== 'Enter' || !(event.ctrlKey || event.metaKey) || !choosing.hidden) return;
    event.preventDefault();
    actions.save();
  });
  const show = (state: Noting): void => {
    const { draft, busy } = state;
    node.hidden = !draft;
    if (!draft) return;
    setText(label, draft.theirs ? t.yourText : t.noteNumber(numberOf(draft, state)));
    if (text.value !== draft.text) text.value = draft.text;
    // A button that is disabled loses the focus.
    const fails = text.readOnly && !busy && document.activeElement === document.body;
    text.readOnly = save.disabled = cancel.disabled = busy;
    if (fails) text.focus();
    both.hidden = choosing.hidden = !draft.theirs;
    saving.hidden = !choosing.hidden;
    setText(theirs, draft.theirs?.text ?? '');
  };
  return { node, show, focus: () => text.focus() };
}

// What the note has in the list, or will have.
export function numberOf({ of }: Draft, state: Noting): number {
  const notes = shownNotes(state);
  const index = of ? notes.findIndex(({ id }) => id === of.id) : -1;
  return (index < 0 ? notes.length : index) + 1;
}

function listView(actions: NoteActions) {
  const node = element('ol', { class: 'notes-list' });
  let shown: readonly unknown[] = [];
  // It is made again only when it is another one, and the focus stays where it was.
  const show = (state: Noting): void => {
    const { notes, away, chosen, mayWrite } = state;
    node.hidden = state.draft !== null || shownNotes(state).length === 0;
    const known = [notes, away, chosen, mayWrite];
    if (known.every((one, i) => one === shown[i])) return;
    shown = known;
    const focused = node.contains(document.activeElement)
      ? document.activeElement?.getAttribute('data-key')
      : null;
    node.replaceChildren(
      ...shownNotes(state).map((note, i) =>
        rowOf(note, i + 1, note.id === chosen, mayWrite, actions),
      ),
    );
    if (focused) node.querySelector<HTMLElement>(`[data-key="${CSS.escape(focused)}"]`)?.focus();
    if (chosenNote(state))
      node.querySelector('[aria-current]')?.scrollIntoView({ block: 'nearest' });
  };
  return { node, show };
}

function rowOf(
  note: Note,
  number: number,
  isChosen: boolean,
  mayChange: boolean,
  actions: NoteActions,
): HTMLElement {
  const choose = element(
    'button',
    {
      type: 'button',
      class: 'note-choose',
      'data-key': note.id,
      'aria-current': isChosen ? 'true' : null,
    },
    element(
      'span',
      { class: 'note-number' },
      element('span', { class: 'unseen' }, t.noteBefore),
      String(number),
    ),
    isChosen
      ? element('span', { class: 'notes-small' }, changedText(note))
      : element('span', { class: 'note-start' }, note.text),
  );
  choose.addEventListener('click', () => actions.choose(note.id));
  if (!isChosen) return element('li', {}, choose);
  const whole = element('p', { class: 'note-whole' }, note.text);
  if (!mayChange) return element('li', { class: 'chosen' }, choose, whole);
  const edit = act(t.edit, t.changesTheText, () => actions.edit());
  const remove = act(t.remove, t.removesTheNoteItCanBe, () => actions.remove(note, number));
  return element(
    'li',
    { class: 'chosen' },
    choose,
    whole,
    element('div', { class: 'buttons' }, edit, remove),
  );
}

function changedText({ changed }: Note): string {
  return changed ? changed.toLocaleString(locale, { dateStyle: 'medium', timeStyle: 'short' }) : '';
}
