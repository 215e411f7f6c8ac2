// What there is of the surface of a scan, and what to do next to have it. Pure functions.
import type { ScanExport } from '../connection/exports';
import { t } from '../texts/texts';
import type { LiveScan } from './live_scan';

export type MeshState =
  | { readonly state: 'none' } // not yet, or nobody has asked
  | { readonly state: 'making'; readonly done: number; readonly message: string } // by the server
  | { readonly state: 'loading'; readonly done: number }
  | { readonly state: 'shown'; readonly triangles: number; readonly textured: boolean }
  | { readonly state: 'failed'; readonly message: string };

export const noMesh: MeshState = { state: 'none' };

// Exports are of scans that have ended, and of a scan without a point there is no surface.
export function mayHaveMesh(scan: LiveScan): boolean {
  const ended = scan.phase === 'finished' || scan.phase === 'interrupted';
  return ended && scan.snapshotComplete && scan.points > 0;
}

// Whether nothing more comes of a scan that has ended: its surface is there, there is none, or, as
// of one that has failed, nobody makes one.
export function isMeshSettled(scan: LiveScan): boolean {
  return (
    scan.mesh.state === 'shown' ||
    scan.mesh.state === 'failed' ||
    (scan.snapshotComplete && !mayHaveMesh(scan))
  );
}

export type MeshStep =
  | { readonly step: 'ask' } // the server to make it
  | { readonly step: 'wait'; readonly done: number; readonly message: string }
  | { readonly step: 'load'; readonly size_bytes: number }
  | { readonly step: 'giveUp'; readonly message: string };

// One that has failed is asked for again when somebody opens the scan once more, not
// by the same page for ever.
export function nextStep(mesh: ScanExport | undefined, asked: boolean): MeshStep {
  if (!mesh) return { step: 'giveUp', message: t.thisServerMakesNoSurfaces };
  switch (mesh.state) {
    case 'ready':
      return { step: 'load', size_bytes: mesh.size_bytes };
    case 'queued':
    case 'running':
      return { step: 'wait', done: mesh.done, message: mesh.words };
    case 'missing':
      return asked ? { step: 'giveUp', message: t.theServerDoesNotMakeIt } : { step: 'ask' };
    case 'failed':
      return asked ? { step: 'giveUp', message: mesh.words } : { step: 'ask' };
  }
}

// A small note on the image; empty when there is nothing to say.
export function meshText(mesh: MeshState, wanted: boolean): string {
  switch (mesh.state) {
    case 'making':
      if (mesh.message) return t.theSurfaceWaits(mesh.message);
      return t.theSurfaceIsBeingMade(percent(mesh.done));
    case 'loading':
      return wanted ? t.loadingTheSurface(percent(mesh.done)) : '';
    case 'failed':
      return wanted ? t.thereIsNoSurfaceOfThis(mesh.message) : '';
    default:
      return '';
  }
}

function percent(share: number): string {
  return `${Math.floor(100 * Math.min(1, share))} %`;
}
