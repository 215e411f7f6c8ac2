// The tape measure of one page: which points were chosen, what came of them, what is kept. Pure.
import type { KeptMeasurement, Measured, Place } from '../connection/measurements';

export interface Measuring {
  readonly active: boolean; // clicks choose points
  readonly first: Place | null; // of two, while the second is missing
  readonly busy: boolean; // the server is asked
  readonly newest: Measured | null; // that is not kept
  readonly kept: readonly KeptMeasurement[];
  readonly problem: string; // in words, or empty
}

export const initialMeasuring: Measuring = { active: false, first: null, busy: false, newest: null, kept: [], problem: '' };

export type MeasuringEvent =
  | { readonly kind: 'active'; readonly active: boolean }
  | { readonly kind: 'chosen'; readonly place: Place | null } // null: nothing was there
  | { readonly kind: 'measured'; readonly measured: Measured }
  | { readonly kind: 'listed'; readonly kept: readonly KeptMeasurement[] }
  | { readonly kind: 'kept'; readonly one: KeptMeasurement }
  | { readonly kind: 'removed'; readonly id: string }
  | { readonly kind: 'failed'; readonly words: string };

export function reduceMeasuring(state: Measuring, event: MeasuringEvent): Measuring {
  switch (event.kind) {
    case 'active':
      return { ...state, active: event.active, first: null, busy: false, newest: null, problem: '' };
    case 'chosen':
      if (state.busy) return state;
      if (!event.place) return { ...state, problem: 'There is nothing: click on a surface.' };
      if (!state.first) return { ...state, first: event.place, newest: null, problem: '' };
      return { ...state, busy: true, problem: '' }; // the second
    case 'measured':
      return state.busy ? { ...state, first: null, busy: false, newest: event.measured } : state;
    case 'listed':
      return { ...state, kept: event.kept };
    case 'kept':
      return { ...state, kept: [...state.kept, event.one], newest: null, problem: '' };
    case 'removed':
      return { ...state, kept: state.kept.filter((one) => one.id !== event.id), problem: '' };
    case 'failed':
      return { ...state, first: null, busy: false, problem: wordsForPeople(event.words) };
  }
}

// What the page asks for now.
export function measuringWords(state: Measuring): string {
  if (state.problem !== '') return state.problem;
  if (state.busy) return 'Measuring …';
  return state.first ? 'Click on the second point.' : state.newest ? 'Click for the next one.' : 'Click on two points.';
}

// A name that no kept one has yet.
export function freeName(kept: readonly KeptMeasurement[]): string {
  const names = new Set(kept.map((one) => one.name));
  let number = kept.length + 1;
  while (names.has(`Distance ${number}`)) ++number;
  return `Distance ${number}`;
}

// The server names the fields of the request.
function wordsForPeople(words: string): string {
  return words.replace('The server says: from: ', 'First point: ').replace('The server says: to: ', 'Second point: ');
}
