// Which way is up in a scan, where somebody has said so: kept in this browser, of the
// scans that were last told.
import type { Direction } from '../scene/gravity';

const storedAs = 'hermite.up';
const kept_count = 100;

type Chosen = readonly (readonly [string, Direction])[]; // the newest last

export function storedUp(storage: Pick<Storage, 'getItem'>, scanId: string): Direction | null {
  return read(storage).find(([id]) => id === scanId)?.[1] ?? null;
}

// Null: it is found again.
export function storeUp(
  storage: Pick<Storage, 'getItem' | 'setItem'>,
  scanId: string,
  up: Direction | null,
): void {
  const others = read(storage).filter(([id]) => id !== scanId);
  const chosen: Chosen = up ? [...others, [scanId, up]] : others;
  try {
    storage.setItem(storedAs, JSON.stringify(chosen.slice(-kept_count)));
  } catch {
    // A browser that keeps nothing.
  }
}

function read(storage: Pick<Storage, 'getItem'>): Chosen {
  try {
    const json: unknown = JSON.parse(storage.getItem(storedAs) ?? '[]');
    return Array.isArray(json) ? (json.filter(isEntry) as unknown as Chosen) : [];
  } catch {
    return [];
  }
}

function isEntry(value: unknown): boolean {
  if (!Array.isArray(value) || typeof value[0] !== 'string' || !Array.isArray(value[1]))
    return false;
  const up: unknown[] = value[1];
  return (
    up.length === 3 &&
    up.every((axis) => typeof axis === 'number' && Number.isFinite(axis)) &&
    Math.abs(Math.hypot(...(up as number[])) - 1) < 0.01
  );
}
