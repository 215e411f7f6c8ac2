// What was taken out of a scan, and what of that can be taken back or done again. Pure.
import type { Axes } from './axes';
import type { Box } from './cutting';

export type BoxKind = 'keep_inside' | 'remove_inside';

export type BoxEdit = Box & { readonly kind: BoxKind; readonly axes: Axes };

// `remove_floating` takes out parts that are connected with nothing.
export type Edit = BoxEdit | { readonly kind: 'remove_floating'; readonly smaller_than_m: number };

export interface EditList {
  readonly version: number; // of the server; grows with each change
  readonly edits: readonly Edit[]; // each is applied to what the ones before it leave
}

export const mostEdits = 16; // of the server

export interface Editing extends EditList {
  readonly known: boolean; // the server has told
  readonly undone: readonly Edit[]; // the last one is done again first
  readonly busy: boolean; // a change is on its way
  readonly problem: 'none' | 'conflict' | string; // why nothing has come of the last one
}

export const initialEditing: Editing = {
  version: 0,
  edits: [],
  known: false,
  undone: [],
  busy: false,
  problem: 'none',
};

export type EditingEvent =
  | { readonly kind: 'read'; readonly list: EditList }
  | { readonly kind: 'saving' }
  | { readonly kind: 'saved'; readonly list: EditList; readonly undone: readonly Edit[] }
  | { readonly kind: 'conflict'; readonly now: EditList }
  | { readonly kind: 'failed'; readonly message: string };

export function reduceEditing(state: Editing, event: EditingEvent): Editing {
  switch (event.kind) {
    case 'read':
      return { ...state, ...event.list, known: true };
    case 'saving':
      return { ...state, busy: true, problem: 'none' };
    case 'saved':
      return { ...state, ...event.list, undone: event.undone, busy: false };
    case 'conflict':
      return { ...state, ...event.now, undone: [], busy: false, problem: 'conflict' };
    case 'failed':
      return { ...state, busy: false, problem: event.message };
  }
}

// The edits and the undone ones after a step.
export interface EditStep {
  readonly edits: readonly Edit[];
  readonly undone: readonly Edit[];
}

// Null: there is no room for one more.
export function added({ edits }: EditList, edit: Edit): EditStep | null {
  return edits.length < mostEdits ? { edits: [...edits, edit], undone: [] } : null;
}

export function undoneOnce({ edits, undone }: Editing): EditStep | null {
  const last = edits.at(-1);
  return last ? { edits: edits.slice(0, -1), undone: [...undone, last] } : null;
}

export function redoneOnce({ edits, undone }: Editing): EditStep | null {
  const next = undone.at(-1);
  return next && edits.length < mostEdits
    ? { edits: [...edits, next], undone: undone.slice(0, -1) }
    : null;
}

// The server takes no box that is thinner; a model may be flat.
const thinnest_m = 0.002;

export function boxEdit(kind: BoxKind, axes: Axes, { low_m, high_m }: Box): BoxEdit {
  const grown_m = (k: 0 | 1 | 2): number => Math.max(0, (thinnest_m - (high_m[k] - low_m[k])) / 2);
  return {
    kind,
    axes,
    low_m: [low_m[0] - grown_m(0), low_m[1] - grown_m(1), low_m[2] - grown_m(2)],
    high_m: [high_m[0] + grown_m(0), high_m[1] + grown_m(1), high_m[2] + grown_m(2)],
  };
}

export function boxEdits(edits: readonly Edit[]): BoxEdit[] {
  return edits.filter((edit): edit is BoxEdit => edit.kind !== 'remove_floating');
}
