import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import type { ChunkKey } from '../connection/events';
import { ChunkLedger, nameOf, pointLimit } from './chunk_ledger';

const key = (x: number): ChunkKey => ({ submap: 0, level: 0, x, y: 0, z: 0 });

interface Update {
  readonly key: ChunkKey;
  readonly version: bigint;
  readonly points: number;
}

// What a viewer shows after these updates, as name -> points.
function shown(updates: readonly Update[]): {
  held: Record<string, number>;
  ledger: ChunkLedger<ChunkKey>;
} {
  const ledger = new ChunkLedger(nameOf, pointLimit);
  ledger.beginSnapshot();
  const held: Record<string, number> = {};
  for (const update of updates) {
    if (ledger.accept(update.key, update.version, update.points) !== 'apply') continue;
    if (update.points === 0) delete held[nameOf(update.key)];
    else held[nameOf(update.key)] = update.points;
  }
  return { held, ledger };
}

// One content for each version, as a server would have sent it.
const history = fc
  .array(
    fc.record({ x: fc.integer({ min: 0, max: 4 }), points: fc.integer({ min: 0, max: 50 }) }),
    { maxLength: 30 },
  )
  .map((rows) =>
    rows.map((row, i): Update => ({ key: key(row.x), version: BigInt(i + 1), points: row.points })),
  );

describe('ChunkLedger', () => {
  it('ends with the newest versions whatever the order and however many duplicates', () => {
    const shuffled = history.chain((updates) =>
      fc.tuple(
        fc.constant(updates),
        fc.shuffledSubarray([...updates, ...updates], { minLength: 2 * updates.length }),
      ),
    );
    fc.assert(
      fc.property(shuffled, ([updates, received]) => {
        const expected = shown(updates);
        const actual = shown(received);
        expect(actual.held).toEqual(expected.held);
        expect(actual.ledger.size).toBe(
          Object.values(expected.held).reduce((sum, points) => sum + points, 0),
        );
        expect(actual.ledger.chunks).toBe(Object.keys(expected.held).length);
      }),
    );
  });

  it('does not let an older version bring a removed chunk back', () => {
    const { held } = shown([
      { key: key(1), version: 7n, points: 0 },
      { key: key(1), version: 6n, points: 10 },
    ]);
    expect(held).toEqual({});
  });

  it('takes lower versions from a new connection and drops what it does not name', () => {
    const { ledger } = shown([
      { key: key(1), version: 90n, points: 10 },
      { key: key(2), version: 91n, points: 20 },
      { key: key(3), version: 92n, points: 0 },
    ]);
    ledger.beginSnapshot();
    expect(ledger.accept(key(1), 1n, 11)).toBe('apply');
    expect(ledger.endSnapshot()).toEqual([key(2)]);
    expect([ledger.size, ledger.chunks]).toEqual([11, 1]);
    expect(ledger.endSnapshot()).toEqual([]);
  });

  it('refuses to grow beyond its limit but still replaces and removes', () => {
    const ledger = new ChunkLedger(nameOf, 100);
    ledger.beginSnapshot();
    expect(ledger.accept(key(1), 1n, 80)).toBe('apply');
    expect(ledger.accept(key(2), 2n, 21)).toBe('full');
    expect(ledger.accept(key(1), 3n, 100)).toBe('apply');
    expect(ledger.accept(key(1), 4n, 101)).toBe('full');
    expect(ledger.accept(key(1), 5n, 0)).toBe('apply');
    expect(ledger.size).toBe(0);
  });
});
