// What comes of a scan passes here: chunks go through ledgers, the scene gets what is new, the
// state the counts. What was shown when a connection was lost stays until the server, which may
// have to build the scan again, has about as much.
import type { ScanEvent } from '../connection/events';
import {
  ChunkLedger,
  nameOf,
  nameOfCube,
  pointLimit,
  triangleLimit,
  type Verdict,
} from './chunk_ledger';
import type { LiveScanEvent } from './live_scan';

export function receiver(
  toState: (event: LiveScanEvent) => void,
  toScene: (event: ScanEvent) => void,
): (event: ScanEvent) => void {
  const chunks = new ChunkLedger(nameOf, pointLimit);
  const pieces = new ChunkLedger(nameOfCube, triangleLimit);
  let full = false;
  let running = true;
  let snapshotEnded = false;
  const verdictOn = (event: ScanEvent): Verdict => {
    if (event.kind === 'chunk')
      return chunks.accept(event.key, event.version, event.points?.count ?? 0);
    if (event.kind === 'meshChunk')
      return pieces.accept(event.cube, event.version, event.piece?.triangles ?? 0);
    return 'apply';
  };
  const mayGo = (ledger: Pick<ChunkLedger<unknown>, 'hasOld' | 'isThin'>): boolean =>
    ledger.hasOld && !(running && ledger.isThin);
  const dropOld = (): void => {
    if (!snapshotEnded) return;
    if (mayGo(chunks))
      for (const key of chunks.endSnapshot())
        toScene({ kind: 'chunk', key, version: 0n, points: null });
    if (mayGo(pieces))
      for (const cube of pieces.endSnapshot())
        toScene({ kind: 'meshChunk', cube, version: 0n, submap: 0, piece: null });
  };
  return (event) => {
    if (event.kind === 'welcome') {
      chunks.beginSnapshot();
      pieces.beginSnapshot();
      snapshotEnded = false;
    }
    if (event.kind === 'snapshotEnd') snapshotEnded = true;
    if (event.kind === 'scanState') running = event.phase === 'running';
    const verdict = verdictOn(event);
    full ||= verdict === 'full';
    if (verdict === 'apply') toScene(event);
    const counts =
      event.kind === 'chunk' ||
      event.kind === 'meshChunk' ||
      event.kind === 'snapshotEnd' ||
      event.kind === 'scanState';
    if (counts) dropOld();
    toState(event);
    if (!counts) return;
    const old = snapshotEnded && (chunks.hasOld || pieces.hasOld);
    toState({
      kind: 'content',
      points: chunks.size,
      chunks: chunks.chunks,
      triangles: pieces.size,
      full,
      old,
    });
  };
}
