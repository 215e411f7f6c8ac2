import { describe, expect, it } from 'vitest';
import {
  added,
  boxEdit,
  boxEdits,
  initialEditing,
  mostEdits,
  redoneOnce,
  reduceEditing,
  undoneOnce,
  type BoxEdit,
  type Edit,
  type Editing,
} from './editing';

const floating = (smaller_than_m: number): Edit => ({ kind: 'remove_floating', smaller_than_m });
const box: BoxEdit = {
  kind: 'keep_inside',
  axes: { along: [1, 0, 0], up: [0, -1, 0] },
  low_m: [0, 0, 0],
  high_m: [1, 1, 1],
};

function known(...edits: Edit[]): Editing {
  return reduceEditing(initialEditing, { kind: 'read', list: { version: 4, edits } });
}

describe('editing', () => {
  it('adds, takes back, and does again', () => {
    const first = added(known(), box)!;
    expect(first).toEqual({ edits: [box], undone: [] });
    const saved = reduceEditing(known(), {
      kind: 'saved',
      list: { version: 5, edits: [box, floating(1)] },
      undone: [],
    });
    const back = undoneOnce(saved)!;
    expect(back).toEqual({ edits: [box], undone: [floating(1)] });
    const after = reduceEditing(saved, {
      kind: 'saved',
      list: { version: 6, edits: back.edits },
      undone: back.undone,
    });
    expect(redoneOnce(after)).toEqual({ edits: [box, floating(1)], undone: [] });
    expect(added(after, floating(2))!.undone).toEqual([]); // another way was taken
    expect(undoneOnce(known())).toBeNull();
    expect(redoneOnce(known(box))).toBeNull();
  });

  it('has room for as many as the server', () => {
    const full = known(...Array.from({ length: mostEdits }, () => box));
    expect(added(full, box)).toBeNull();
    expect(redoneOnce({ ...full, undone: [box] })).toBeNull();
  });

  it('takes what somebody else has done, and forgets what was undone before it', () => {
    const state = { ...known(box), undone: [floating(1)], busy: true };
    const after = reduceEditing(state, { kind: 'conflict', now: { version: 9, edits: [] } });
    expect(after).toMatchObject({
      version: 9,
      edits: [],
      undone: [],
      busy: false,
      problem: 'conflict',
    });
    expect(reduceEditing(after, { kind: 'saving' }).problem).toBe('none');
    expect(reduceEditing(state, { kind: 'failed', message: 'no' })).toMatchObject({
      edits: [box],
      busy: false,
      problem: 'no',
    });
  });

  it('makes boxes of flat models as thick as the server wants them', () => {
    const { low_m, high_m } = boxEdit('keep_inside', box.axes, {
      low_m: [0, 1, 0],
      high_m: [1, 1, 1],
    });
    expect(low_m).toEqual([0, 0.999, 0]);
    expect(high_m).toEqual([1, 1.001, 1]);
  });

  it('has boxes, which the scene hides by', () => {
    expect(boxEdits([floating(1), box])).toEqual([box]);
  });
});
