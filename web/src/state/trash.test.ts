import { describe, expect, it } from 'vitest';
import { Trash, undoFor_ms, type Deleted } from './trash';

function world(refuse = false): {
  trash: Trash;
  asked: string[];
  failed: Deleted[];
  pass: () => Promise<void>;
} {
  const asked: string[] = [];
  const failed: Deleted[] = [];
  const timers = new Map<number, () => void>();
  let next = 0;
  const trash = new Trash(
    {
      delete: async (id, leaving) => {
        asked.push(leaving ? `${id} leaving` : id);
        if (refuse) throw new Error('no');
      },
      after: (delay_ms, action) => {
        expect(delay_ms).toBe(undoFor_ms);
        const timer = next++;
        timers.set(timer, action);
        return () => timers.delete(timer);
      },
    },
    () => {},
    (one) => failed.push(one),
  );
  const pass = async (): Promise<void> => {
    for (const action of [...timers.values()]) action();
    await new Promise((resolve) => setTimeout(resolve));
  };
  return { trash, asked, failed, pass };
}

const kitchen = { id: 'k', title: 'Kitchen' };

describe('Trash', () => {
  it('deletes when nobody takes it back, once', async () => {
    const { trash, asked, pass } = world();
    trash.put(kitchen);
    trash.put(kitchen);
    expect(trash.has('k')).toBe(true);
    expect(trash.newest).toEqual(kitchen);
    expect(asked).toEqual([]);
    await pass();
    expect(asked).toEqual(['k']);
    expect(trash.has('k')).toBe(true); // lists that are under way still have it
    expect(trash.newest).toBeNull();
    trash.undo('k'); // too late
    expect(trash.has('k')).toBe(true);
  });

  it('deletes nothing that was taken back', async () => {
    const { trash, asked, pass } = world();
    trash.put(kitchen);
    trash.undo('k');
    await pass();
    expect(asked).toEqual([]);
    expect(trash.has('k')).toBe(false);
  });

  it('brings back what the server keeps, and says so', async () => {
    const { trash, failed, pass } = world(true);
    trash.put(kitchen);
    await pass();
    expect(trash.has('k')).toBe(false);
    expect(failed).toEqual([kitchen]);
  });

  it('waits no longer when the page goes', () => {
    const { trash, asked } = world();
    trash.put(kitchen);
    trash.emptyAll();
    expect(asked).toEqual(['k leaving']);
  });
});
