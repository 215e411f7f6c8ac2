import { expect, test } from 'vitest';
import type { NewNote, Note, NoteView } from '../connection/notes';
import { saveDraft, type NoteServer } from './note_saving';
import { initialNoting, reduceNoting, type Noting, type NotingEvent } from './noting';
import { createStore } from './store';

const view: NoteView = { position_m: [0, 0, -1], target_m: [0, 0, 1] };
const click = { kind: 'placed', position_m: [4, 5, 6], view } as const;

// A server whose answers are given by hand.
function world() {
  const sent: string[] = [];
  const answers: ((note: Note | Error) => void)[] = [];
  const asked = (text: string): Promise<Note> => {
    sent.push(text);
    return new Promise((resolve, reject) =>
      answers.push((answer) => (answer instanceof Error ? reject(answer) : resolve(answer))),
    );
  };
  const server: NoteServer = {
    create: ({ text }: NewNote) => asked(text),
    change: (_, text) => asked(text).then((changed) => ({ kind: 'done', note: changed })),
  };
  const store = createStore<Noting, NotingEvent>(
    { ...initialNoting, active: true, mayWrite: true },
    reduceNoting,
  );
  return { sent, answers, server, store };
}

const note: Note = {
  id: 'a',
  position_m: [4, 5, 6],
  view,
  text: 'a crack',
  version: 1,
  changed: null,
};
const settled = (): Promise<void> => new Promise((resolve) => setTimeout(resolve));

test('a note that is saved twice is written once, and what is begun afterwards stays', async () => {
  const { sent, answers, server, store } = world();
  store.dispatch(click);
  store.dispatch({ kind: 'typed', text: ' a crack ' });
  for (let i = 0; i < 2; ++i) saveDraft(store, server);
  expect(sent).toEqual(['a crack']);
  answers[0]!(note);
  await settled();
  expect(store.get()).toMatchObject({ draft: null, busy: false, chosen: 'a' });
  store.dispatch(click);
  store.dispatch({ kind: 'typed', text: 'another' });
  await settled();
  expect(store.get().draft?.text).toBe('another');
});

test('a change that is saved twice is sent once, and a failed one can be saved again', async () => {
  const { sent, answers, server, store } = world();
  for (const event of [
    { kind: 'listed', notes: [note] },
    { kind: 'chosen', id: 'a' },
    { kind: 'edited' },
    { kind: 'typed', text: 'mine' },
  ] as const)
    store.dispatch(event);
  for (let i = 0; i < 2; ++i) saveDraft(store, server);
  answers[0]!(new Error('lost'));
  await settled();
  expect(store.get()).toMatchObject({
    busy: false,
    problem: 'That did not work.',
    draft: { text: 'mine' },
  });
  saveDraft(store, server);
  expect(sent).toEqual(['mine', 'mine']);
});

test('what cannot be saved is not sent', () => {
  const { sent, server, store } = world();
  saveDraft(store, server);
  store.dispatch(click);
  saveDraft(store, server);
  expect(sent).toEqual([]);
  expect(store.get().problem).toContain('at least one letter');
});
