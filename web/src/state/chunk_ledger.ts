// Which chunks the viewer holds, and in which version: of points, or the pieces of a surface.
//
// Versions only grow within one connection, so an older or equal one is ignored: duplicates
// and reordering do no harm. A new connection (perhaps to a restarted server that counts
// afresh) starts a new snapshot: any version is taken then, and what the snapshot did not name
// again is dropped at its end.
import type { ChunkKey, MeshCube } from '../connection/events';

// About 28 bytes a point on the graphics card: 340 MB.
export const pointLimit = 12_000_000;
// About 24 bytes a triangle, half a vertex of 20 among them: 190 MB.
export const triangleLimit = 8_000_000;

export type Verdict = 'apply' | 'ignore' | 'full';

interface Entry<Key> {
  readonly key: Key;
  version: bigint;
  // Points or triangles. 0: removed, remembered so that a late older version cannot bring it back.
  size: number;
  snapshot: number;
}

export class ChunkLedger<Key> {
  private readonly entries = new Map<string, Entry<Key>>();
  private snapshot = 0;
  private sizeTotal = 0;
  private chunkTotal = 0;
  private freshTotal = 0; // of the entries that this snapshot has named
  private sizeBefore = 0; // when it began

  constructor(
    private readonly textOf: (key: Key) => string,
    private readonly limit: number,
  ) {}

  // Points or triangles.
  get size(): number {
    return this.sizeTotal;
  }
  get chunks(): number {
    return this.chunkTotal;
  }

  // Far less than there was before this snapshot.
  get isThin(): boolean {
    return 2 * this.freshTotal < this.sizeBefore;
  }
  get hasOld(): boolean {
    return this.sizeTotal > this.freshTotal;
  }

  beginSnapshot(): void {
    ++this.snapshot;
    this.freshTotal = 0;
    this.sizeBefore = this.sizeTotal;
  }

  // `size` 0 removes the chunk. Only 'apply' changes what is held.
  accept(key: Key, version: bigint, size: number): Verdict {
    const name = this.textOf(key);
    const held = this.entries.get(name);
    if (held && held.snapshot === this.snapshot && version <= held.version) return 'ignore';
    const growth = size - (held?.size ?? 0);
    if (growth > 0 && this.sizeTotal + growth > this.limit) return 'full';
    this.sizeTotal += growth;
    this.freshTotal += size - (held?.snapshot === this.snapshot ? held.size : 0);
    this.chunkTotal += Number(size > 0) - Number((held?.size ?? 0) > 0);
    this.entries.set(name, { key, version, size, snapshot: this.snapshot });
    return 'apply';
  }

  // Returns the chunks that this snapshot no longer has; they are forgotten.
  endSnapshot(): Key[] {
    const gone: Key[] = [];
    this.sizeBefore = 0; // there is nothing to compare with any more
    for (const [name, entry] of this.entries) {
      if (entry.snapshot === this.snapshot) continue;
      this.entries.delete(name);
      if (entry.size === 0) continue;
      gone.push(entry.key);
      this.sizeTotal -= entry.size;
      --this.chunkTotal;
    }
    return gone;
  }
}

export function nameOf(key: ChunkKey): string {
  return `${key.submap}/${key.level}/${key.x}/${key.y}/${key.z}`;
}

export function nameOfCube(cube: MeshCube): string {
  return `${cube.part}/${cube.x}/${cube.y}/${cube.z}`;
}
