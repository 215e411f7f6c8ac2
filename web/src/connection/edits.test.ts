import { afterEach, describe, expect, it, vi } from 'vitest';
import { threeOf } from '../state/axes';
import type { EditList } from '../state/editing';
import { conflictIn, parseEdits, saveEdits } from './edits';

const axes = { along: [0.6, 0, 0.8], up: [0, -1, 0] } as const;
const list: EditList = {
  version: 3,
  edits: [
    { kind: 'remove_inside', axes, low_m: [-1, 0, 2], high_m: [1, 2, 3] },
    { kind: 'remove_floating', smaller_than_m: 0.3 },
  ],
};

afterEach(() => vi.unstubAllGlobals());

function answering(body: unknown, status = 200) {
  const fetched = vi.fn(
    async (_url: string, _init: RequestInit) => new Response(JSON.stringify(body), { status }),
  );
  vi.stubGlobal('fetch', fetched);
  return fetched;
}

const sent = (fetched: ReturnType<typeof answering>): unknown =>
  JSON.parse(String(fetched.mock.calls[0]![1].body));

describe('edits', () => {
  it('are sent as they are read', async () => {
    const fetched = answering({ version: 4, edits: [] });
    expect(await saveEdits('s', 'token', list)).toEqual({
      kind: 'done',
      now: { version: 4, edits: [] },
    });
    expect(fetched.mock.calls[0]![0]).toContain('/scans/s/edits');
    expect(parseEdits(sent(fetched))).toEqual(list);
  });

  it('of boxes whose third direction is the other way are the same boxes', () => {
    const [along, up, across] = threeOf(axes);
    const other = across.map((value) => -value);
    const box = { axes: [along, up, other], low_m: [-1, 0, -3], high_m: [1, 2, -2] };
    expect(parseEdits({ version: 3, edits: [{ kind: 'remove_inside', box }] }).edits[0]).toEqual(
      list.edits[0],
    );
  });

  it('of somebody else come with the refusal', async () => {
    const now = { version: 7, edits: [{ kind: 'remove_floating', smaller_than_m: 1 }] };
    answering({ error: { code: 'busy', message: 'meanwhile' }, edits: now }, 409);
    expect(await saveEdits('s', 'token', list)).toEqual({ kind: 'conflict', now });
    answering({ error: { code: 'busy', message: 'the scan is running' } }, 409);
    await expect(saveEdits('s', 'token', list)).rejects.toThrow('the scan is running');
    expect(conflictIn('{')).toBeNull();
  });

  it('that are not known are not read, so that no change loses them', () => {
    for (const edit of [
      { kind: 'melt' },
      { kind: 'keep_inside' },
      { kind: 'remove_floating' },
      null,
    ])
      expect(() => parseEdits({ version: 1, edits: [edit] })).toThrow();
    expect(() => parseEdits({ edits: [] })).toThrow();
  });
});
