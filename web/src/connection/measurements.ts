// Distances in a scan that has ended: the server fits the surface, says how far two places are apart, and keeps what is worth it.
import { ApiError, isRecord, numberOf, request, textOf } from './api';

const limit_ms = 30_000; // it reads all of a large scan

export type Place = readonly [number, number, number]; // in the world of the scan, metres

export interface Measured {
  readonly from: Place; // on the surface
  readonly to: Place;
  readonly words: string; // "1.234 m ± 0.003 m (95 %)"
}

export interface KeptMeasurement extends Measured {
  readonly id: string;
  readonly name: string;
}

const pathOf = (scanId: string): string => `api/v1/scans/${encodeURIComponent(scanId)}`;
const headers = { 'Content-Type': 'application/json' };

export async function measure(scanId: string, token: string, from: Place, to: Place): Promise<Measured> {
  const response = await request(`${pathOf(scanId)}/measure`, token, { limit_ms, method: 'POST', headers, body: JSON.stringify({ from, to }) });
  return parseMeasured(await response.json());
}

// Measured again there, and kept with the scan.
export async function keepMeasurement(scanId: string, token: string, name: string, { from, to }: Measured): Promise<KeptMeasurement> {
  const response = await request(`${pathOf(scanId)}/measurements`, token, { limit_ms, method: 'POST', headers, body: JSON.stringify({ name, from, to }) });
  return parseKept(await response.json());
}

export async function fetchMeasurements(scanId: string, token: string): Promise<KeptMeasurement[]> {
  const response = await request(`${pathOf(scanId)}/measurements`, token, { limit_ms });
  return parseMeasurements(await response.json());
}

export async function removeMeasurement(scanId: string, token: string, id: string): Promise<void> {
  await request(`${pathOf(scanId)}/measurements/${encodeURIComponent(id)}`, token, { limit_ms, method: 'DELETE' });
}

export async function fetchMeasurementsCsv(scanId: string, token: string): Promise<Blob> {
  const response = await request(`${pathOf(scanId)}/measurements.csv`, token, { limit_ms });
  return response.blob();
}

export function parseMeasured(json: unknown): Measured {
  const from = isRecord(json) ? placeOf(json['from']) : null;
  const to = isRecord(json) ? placeOf(json['to']) : null;
  const words = isRecord(json) ? textOf(json['words']) : '';
  if (!from || !to || words === '') throw new ApiError('The server’s answer cannot be read.', false);
  return { from, to, words };
}

// Rows that are none are left out.
export function parseMeasurements(json: unknown): KeptMeasurement[] {
  const rows = isRecord(json) && Array.isArray(json['measurements']) ? json['measurements'] : null;
  if (!rows) throw new ApiError('The server’s answer cannot be read.', false);
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
  if (textOf(id) === '') throw new ApiError('The server’s answer cannot be read.', false);
  return { ...measured, id: textOf(id), name: textOf(name) };
}

function placeOf(value: unknown): Place | null {
  if (!Array.isArray(value) || value.length !== 3) return null;
  const numbers = value.map(numberOf);
  return numbers.some((number) => number === null) ? null : (numbers as unknown as Place);
}
