// What is measured in a scan that has ended: the server fits the surface, says what lies between
// places, and keeps what is worth it.
import { t } from '../texts/texts';
import { ApiError, isRecord, numberOf, request, textOf, scanPath } from './api';

const limit_ms = 30_000; // it reads all of a large scan

// As the server names them.
export const measureKinds = ['distance', 'plane', 'height', 'angle', 'area'] as const;
export type MeasureKind = (typeof measureKinds)[number];

// In the world of the scan, in metres; or a direction in it.
export type Place = readonly [number, number, number];

export interface Asked {
  readonly kind: MeasureKind;
  readonly points: readonly Place[]; // near to surfaces
  readonly up?: Place; // unit, of a height alone
}

export interface Measured extends Asked {
  // Of the surface at each point; empty for what was kept by servers that had no normals.
  readonly normals: readonly Place[];
  readonly words: string; // "1.234 m ± 0.003 m (95 %)"
}

export interface KeptMeasurement extends Measured {
  readonly id: string;
  readonly name: string;
}

const headers = { 'Content-Type': 'application/json' };
const bodyOf = ({ kind, points, up }: Asked) => ({ kind, points, ...(up ? { up } : {}) });

export async function measure(scanId: string, token: string, asked: Asked): Promise<Measured> {
  const response = await request(`${scanPath(scanId)}/measure`, token, {
    limit_ms,
    method: 'POST',
    headers,
    body: JSON.stringify(bodyOf(asked)),
  });
  return parseMeasured(await response.json());
}

// Measured again there, and kept with the scan.
export async function keepMeasurement(
  scanId: string,
  token: string,
  name: string,
  asked: Asked,
): Promise<KeptMeasurement> {
  const response = await request(`${scanPath(scanId)}/measurements`, token, {
    limit_ms,
    method: 'POST',
    headers,
    body: JSON.stringify({ name, ...bodyOf(asked) }),
  });
  return parseKept(await response.json());
}

export async function fetchMeasurements(scanId: string, token: string): Promise<KeptMeasurement[]> {
  const response = await request(`${scanPath(scanId)}/measurements`, token, { limit_ms });
  return parseMeasurements(await response.json());
}

export async function removeMeasurement(scanId: string, token: string, id: string): Promise<void> {
  await request(`${scanPath(scanId)}/measurements/${encodeURIComponent(id)}`, token, {
    limit_ms,
    method: 'DELETE',
  });
}

export async function fetchMeasurementsCsv(scanId: string, token: string): Promise<Blob> {
  const response = await request(`${scanPath(scanId)}/measurements.csv`, token, { limit_ms });
  return response.blob();
}

export function parseMeasured(json: unknown): Measured {
  const unreadable = new ApiError(t.theServersAnswerCannotBeRead, false);
  if (!isRecord(json)) throw unreadable;
  const kind = measureKinds.find((one) => one === json['kind']);
  const points = placesOf(json['points']);
  const normals = placesOf(json['normals']);
  const up = json['up'] === undefined ? undefined : placeOf(json['up']);
  const words = textOf(json['words']);
  if (!kind || !points || points.length < 2 || !normals || up === null || words === '')
    throw unreadable;
  if ((kind === 'plane' || kind === 'angle') && normals.length !== points.length) throw unreadable;
  if ((kind === 'height') !== (up !== undefined)) throw unreadable;
  return { kind, points, normals, words, ...(up ? { up } : {}) };
}

// Rows that are none are left out.
export function parseMeasurements(json: unknown): KeptMeasurement[] {
  const rows = isRecord(json) && Array.isArray(json['measurements']) ? json['measurements'] : null;
  if (!rows) throw new ApiError(t.theServersAnswerCannotBeRead, false);
  return rows.flatMap((row) => {
    try {
      return [parseKept(row)];
    } catch {
      return [];
    }
  });
}

function parseKept(json: unknown): KeptMeasurement {
  const measured = parseMeasured(json);
  const { id, name } = json as Record<string, unknown>;
  if (textOf(id) === '') throw new ApiError(t.theServersAnswerCannotBeRead, false);
  return { ...measured, id: textOf(id), name: textOf(name) };
}

function placesOf(value: unknown): Place[] | null {
  if (!Array.isArray(value)) return null;
  const places = value.map(placeOf);
  return places.some((place) => place === null) ? null : (places as Place[]);
}

// Null: no three numbers.
export function placeOf(value: unknown): Place | null {
  if (!Array.isArray(value) || value.length !== 3) return null;
  const numbers = value.map(numberOf);
  return numbers.some((number) => number === null) ? null : (numbers as unknown as Place);
}
