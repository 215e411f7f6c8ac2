// Which chunks the viewer holds, and in which version.
//
// Versions only grow within one connection, so an older or equal one is ignored: duplicates and reordering do no harm. A new connection (perhaps to
// a restarted server that counts afresh) starts a new snapshot: any version is taken then, and what the snapshot did not name again is dropped at its end.
import type { ChunkKey } from '../connection/events';

// About 20 bytes a point on the graphics card: 240 MB.
export const pointLimit = 12_000_000;

export type Verdict = 'apply' | 'ignore' | 'full';

interface Entry {
  readonly key: ChunkKey;
  version: bigint;
  points: number; // 0: removed, remembered so that a late older version cannot bring it back
  snapshot: number;
}

export class ChunkLedger {
  private readonly entries = new Map<string, Entry>();
  private snapshot = 0;
  private pointTotal = 0;
  private chunkTotal = 0;

  constructor(private readonly limit = pointLimit) {}

  get points(): number {
    return this.pointTotal;
  }
  get chunks(): number {
    return this.chunkTotal;
  }

  beginSnapshot(): void {
    ++this.snapshot;
  }

  // `points` 0 removes the chunk. Only 'apply' changes what is held.
  accept(key: ChunkKey, version: bigint, points: number): Verdict {
    const name = nameOf(key);
    const held = this.entries.get(name);
    if (held && held.snapshot === this.snapshot && version <= held.version) return 'ignore';
    const growth = points - (held?.points ?? 0);
    if (growth > 0 && this.pointTotal + growth > this.limit) return 'full';
    this.pointTotal += growth;
    this.chunkTotal += Number(points > 0) - Number((held?.points ?? 0) > 0);
    this.entries.set(name, { key, version, points, snapshot: this.snapshot });
    return 'apply';
  }

  // Returns the chunks that this snapshot no longer has; they are forgotten.
  endSnapshot(): ChunkKey[] {
    const gone: ChunkKey[] = [];
    for (const [name, entry] of this.entries) {
      if (entry.snapshot === this.snapshot) continue;
      this.entries.delete(name);
      if (entry.points === 0) continue;
      gone.push(entry.key);
      this.pointTotal -= entry.points;
      --this.chunkTotal;
    }
    return gone;
  }
}

export function nameOf(key: ChunkKey): string {
  return `${key.submap}/${key.level}/${key.x}/${key.y}/${key.z}`;
}
