// What a scan that has ended can be taken away as: the list, asking for one, and taking it.
import { t } from '../texts/texts';
import { ApiError, isRecord, numberOf, request, textOf, scanPath } from './api';

const limit_ms = 10_000;
const downloadLimit_ms = 30 * 60_000;
const jsonType = { 'Content-Type': 'application/json' };

export const viewerMesh = 'glb-draco'; // the server's kViewerMesh
export const importedMesh = 'imported'; // and its kImportedMesh: of a scan that is nothing else

export const exportStates = ['missing', 'queued', 'running', 'ready', 'failed'] as const;
export type ExportStateName = (typeof exportStates)[number];

// How a mesh is finished before it is written. All 0: as it is.
export interface MeshFinish {
  readonly simplify_um: number; // how far the surface may move for fewer triangles
  readonly triangles: number; // with that: not fewer than these
  readonly fill_holes_mm: number; // holes up to that width are filled
  readonly close: boolean; // all that is open
}

export const asItIs: MeshFinish = { simplify_um: 0, triangles: 0, fill_holes_mm: 0, close: false };

export interface ScanExport {
  readonly format: string;
  readonly of_format: string; // the same where the mesh is as it is
  readonly finish: MeshFinish;
  readonly kind: string; // mesh, cloud, plan, path
  readonly label: string;
  readonly file: string; // with its ending
  readonly state: ExportStateName;
  readonly size_bytes: number; // of one that is ready
  readonly done: number; // share, of one that is made
  readonly words: string; // why it has failed, or still waits
}

// The mesh that the viewer shows. One that was imported is kept as it came: with
// edits there is another one.
export function shownMesh(
  exports: readonly ScanExport[],
  isEdited: boolean,
): ScanExport | undefined {
  const imported = isEdited ? undefined : exports.find((one) => one.format === importedMesh);
  return imported ?? exports.find((one) => one.format === viewerMesh);
}

export function isAlike(a: MeshFinish, b: MeshFinish): boolean {
  return (
    a.simplify_um === b.simplify_um &&
    a.triangles === b.triangles &&
    a.fill_holes_mm === b.fill_holes_mm &&
    a.close === b.close
  );
}

// With options, beside the export of its format as it is.
export function isMade(one: ScanExport): boolean {
  return one.format !== one.of_format;
}

// What `plain` is with its mesh finished so; one that nobody has asked for is missing and has
// no format of its own yet.
export function finishedAs(
  exports: readonly ScanExport[],
  plain: ScanExport,
  finish: MeshFinish,
): ScanExport {
  const there = exports.find(
    (one) => one.of_format === plain.of_format && isAlike(one.finish, finish),
  );
  return (
    there ?? { ...plain, format: '', finish, state: 'missing', size_bytes: 0, done: 0, words: '' }
  );
}

const pathOf = (scanId: string): string => `${scanPath(scanId)}/exports`;

export async function fetchExports(scanId: string, token: string): Promise<ScanExport[]> {
  const response = await request(pathOf(scanId), token, { limit_ms });
  return parseExports(await response.json());
}

// As it is now: queued, running, or ready already.
export async function requestExport(
  scanId: string,
  format: string,
  token: string,
  finish: MeshFinish = asItIs,
): Promise<ScanExport> {
  const body = JSON.stringify(isAlike(finish, asItIs) ? { format } : { format, ...finish });
  const response = await request(pathOf(scanId), token, {
    limit_ms,
    method: 'POST',
    headers: jsonType,
    body,
  });
  const json: unknown = await response.json();
  if (!isRecord(json)) throw new ApiError(t.theServersAnswerCannotBeRead, false);
  return exportOf(json);
}

// Stops it where it is being made. Exports of the scan with options count against a limit of the
// server until they are removed.
export async function removeExport(scanId: string, format: string, token: string): Promise<void> {
  await request(`${pathOf(scanId)}/${encodeURIComponent(format)}`, token, {
    limit_ms,
    method: 'DELETE',
  });
}

// `progress` is told the bytes that have come.
export async function fetchExport(
  scanId: string,
  format: string,
  token: string,
  progress: (loaded_bytes: number) => void,
  signal?: AbortSignal,
): Promise<Blob> {
  const response = await request(`${pathOf(scanId)}/${encodeURIComponent(format)}`, token, {
    limit_ms: downloadLimit_ms,
    ...(signal ? { signal } : {}),
  });
  const reader = response.body?.getReader();
  if (!reader) return response.blob();
  const pieces: Uint8Array<ArrayBuffer>[] = [];
  let loaded_bytes = 0;
  for (;;) {
    const { done, value } = await reader.read().catch(() => {
      throw new ApiError(t.theDownloadWasCutOff, false, true);
    });
    if (done) break;
    pieces.push(value as Uint8Array<ArrayBuffer>);
    progress((loaded_bytes += value.length));
  }
  return new Blob(pieces, { type: response.headers.get('Content-Type') ?? '' });
}

// Entries that cannot be read are left out.
export function parseExports(json: unknown): ScanExport[] {
  const rows = isRecord(json) && Array.isArray(json['exports']) ? json['exports'] : null;
  if (!rows) throw new ApiError(t.theServersListOfExportsCannot, false);
  return rows
    .filter(isRecord)
    .filter((row) => textOf(row['format']) !== '')
    .map(exportOf);
}

function exportOf(row: Record<string, unknown>): ScanExport {
  const state = exportStates.find((name) => name === row['state']) ?? 'missing';
  return {
    format: textOf(row['format']),
    of_format: textOf(row['of_format']) || textOf(row['format']),
    finish: {
      simplify_um: numberOf(row['simplify_um']) ?? 0,
      triangles: numberOf(row['triangles']) ?? 0,
      fill_holes_mm: numberOf(row['fill_holes_mm']) ?? 0,
      close: row['close'] === true,
    },
    kind: textOf(row['kind']),
    label: textOf(row['label']) || textOf(row['format']),
    file: textOf(row['file']) || textOf(row['format']),
    state,
    size_bytes: numberOf(row['bytes']) ?? 0,
    done: Math.min(1, Math.max(0, numberOf(row['done']) ?? 0)),
    words: textOf(row['words']),
  };
}
