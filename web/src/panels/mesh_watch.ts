// Gets the surface of a scan that has ended: asks the server to make it if nobody has, waits, loads it and puts it into the scene.
import { ApiError } from '../connection/api';
import { fetchExport, fetchExports, requestExport, shownMesh, viewerMesh } from '../connection/exports';
import { loadMesh } from '../scene/mesh_loader';
import type { ScanScene } from '../scene/scene';
import type { LiveScan, LiveScanEvent } from '../state/live_scan';
import { mayHaveMesh, nextStep, type MeshState } from '../state/mesh';
import type { Store } from '../state/store';
import { t } from '../texts/texts';

const pollEvery_ms = 1_500;
const retryEvery_ms = 6_000; // while the server cannot be reached

export interface MeshWatch {
  dispose(): void;
}

export function watchMesh(scan: Store<LiveScan, LiveScanEvent>, scene: Pick<ScanScene, 'showMesh'>, token: string): MeshWatch {
  const ended = new AbortController();
  let timer: ReturnType<typeof setTimeout> | undefined;
  let begun = false;
  let asked = false;
  const { scanId } = scan.get();
  const tell = (mesh: MeshState): void => {
    if (!ended.signal.aborted) scan.dispatch({ kind: 'mesh', mesh });
  };
  const again = (delay_ms: number): void => {
    timer = setTimeout(() => void step(), delay_ms);
  };
  const load = async (format: string, size_bytes: number): Promise<void> => {
    tell({ state: 'loading', done: 0 });
    const blob = await fetchExport(
      scanId,
      format,
      token,
      (loaded_bytes) => tell({ state: 'loading', done: loaded_bytes / Math.max(1, size_bytes) }),
      ended.signal,
    );
    const root = await loadMesh(await blob.arrayBuffer());
    if (!ended.signal.aborted) tell({ state: 'shown', ...scene.showMesh(root) });
  };
  const step = async (): Promise<void> => {
    if (ended.signal.aborted) return;
    try {
      const mesh = shownMesh(await fetchExports(scanId, token));
      const next = nextStep(mesh, asked);
      if (next.step === 'giveUp') tell({ state: 'failed', message: next.message });
      if (mesh && next.step === 'load') await load(mesh.format, next.size_bytes);
      if (next.step === 'wait') tell({ state: 'making', done: next.done, message: next.message });
      if (next.step === 'ask') {
        asked = true;
        await requestExport(scanId, viewerMesh, token);
      }
      if (next.step === 'ask' || next.step === 'wait') again(pollEvery_ms);
    } catch (error) {
      if (error instanceof ApiError && error.passing) again(retryEvery_ms);
      else tell({ state: 'failed', message: messageOf(error) });
    }
  };
  const unsubscribe = scan.subscribe((state) => {
    if (begun || !mayHaveMesh(state)) return;
    begun = true;
    void step();
  });
  return {
    dispose() {
      ended.abort();
      clearTimeout(timer);
      unsubscribe();
    },
  };
}

function messageOf(error: unknown): string {
  const text = error instanceof Error ? error.message : t.itCouldNotBeLoaded;
  return text.replace(/\.$/, '');
}
