// Gets the surface of a scan that has ended: asks the server to make it if nobody has, waits, loads
// it and puts it into the scene. After an edit it does so again.
import type { Object3D } from 'three';
import { ApiError } from '../connection/api';
import {
  fetchExport,
  fetchExports,
  requestExport,
  shownMesh,
  viewerMesh,
} from '../connection/exports';
import { thumbnails } from '../connection/thumbnails';
import { loadMesh } from '../scene/mesh_loader';
import type { ScanScene } from '../scene/scene';
import type { LiveScan, LiveScanEvent } from '../state/live_scan';
import { mayHaveMesh, nextStep, type MeshState } from '../state/mesh';
import type { Store } from '../state/store';
import { t } from '../texts/texts';

const pollEvery_ms = 1_500;
const retryEvery_ms = 6_000; // while the server cannot be reached

export interface MeshWatch {
  again(): void;
  dispose(): void;
}

interface World {
  readonly scan: Store<LiveScan, LiveScanEvent>;
  readonly scene: Pick<ScanScene, 'showMesh'>;
  readonly token: string;
  readonly isEdited: () => Promise<boolean>;
}

export function watchMesh({ scan, scene, token, isEdited }: World): MeshWatch {
  let run = new AbortController(); // of asking, waiting and loading
  let timer: ReturnType<typeof setTimeout> | undefined;
  let begun = false;
  let asked = false;
  const { scanId } = scan.get();
  const tell = (mesh: MeshState, { aborted }: AbortSignal): void => {
    if (!aborted) scan.dispatch({ kind: 'mesh', mesh });
  };
  const later = (delay_ms: number, signal: AbortSignal): void => {
    if (!signal.aborted) timer = setTimeout(() => void step(signal), delay_ms);
  };
  const load = async (format: string, size_bytes: number, signal: AbortSignal): Promise<void> => {
    const root = await surfaceOf({
      scanId,
      token,
      format,
      size_bytes,
      signal,
      tell: (done) => tell({ state: 'loading', done }, signal),
    });
    thumbnails.forget(scanId); // which comes with the mesh if it was edited
    if (!signal.aborted) tell({ state: 'shown', ...scene.showMesh(root) }, signal);
  };
  const step = async (signal: AbortSignal): Promise<void> => {
    if (signal.aborted) return;
    try {
      const mesh = shownMesh(await fetchExports(scanId, token), await isEdited());
      const next = nextStep(mesh, asked);
      if (next.step === 'giveUp') tell({ state: 'failed', message: next.message }, signal);
      if (mesh && next.step === 'load') await load(mesh.format, next.size_bytes, signal);
      if (next.step === 'wait')
        tell({ state: 'making', done: next.done, message: next.message }, signal);
      if (next.step === 'ask' && !signal.aborted) {
        asked = true;
        await requestExport(scanId, viewerMesh, token);
      }
      if (next.step === 'ask' || next.step === 'wait') later(pollEvery_ms, signal);
    } catch (error) {
      if (error instanceof ApiError && error.passing) later(retryEvery_ms, signal);
      else tell({ state: 'failed', message: messageOf(error) }, signal);
    }
  };
  const begin = (): void => {
    run.abort();
    clearTimeout(timer);
    run = new AbortController();
    asked = false;
    begun = true;
    void step(run.signal);
  };
  const unsubscribe = scan.subscribe((state) => {
    if (!begun && mayHaveMesh(state)) begin();
  });
  return {
    again() {
      if (begun) begin();
    },
    dispose() {
      run.abort();
      clearTimeout(timer);
      unsubscribe();
    },
  };
}

interface Wanted {
  readonly scanId: string;
  readonly token: string;
  readonly format: string;
  readonly size_bytes: number;
  readonly signal: AbortSignal;
  readonly tell: (done: number) => void; // the share that has come
}

async function surfaceOf({
  scanId,
  token,
  format,
  size_bytes,
  signal,
  tell,
}: Wanted): Promise<Object3D> {
  tell(0);
  const came = (loaded_bytes: number): void => tell(loaded_bytes / Math.max(1, size_bytes));
  const blob = await fetchExport(scanId, format, token, came, signal);
  return loadMesh(await blob.arrayBuffer());
}

function messageOf(error: unknown): string {
  const text = error instanceof Error ? error.message : t.itCouldNotBeLoaded;
  return text.replace(/\.$/, '');
}
