// What somebody has taken out of a scan that has ended: its results stay, and the list is applied
// to what is shown and downloaded. A change names the version that it was made of.
import { dot, threeOf, unit, type Axes } from '../state/axes';
import type { Box } from '../state/cutting';
import type { BoxKind, Edit, EditList } from '../state/editing';
import { t } from '../texts/texts';
import { ApiError, isRecord, numberOf, refusalOf, request, scanPath } from './api';
import { placeOf } from './measurements';

const limit_ms = 15_000;
const headers = { 'Content-Type': 'application/json' };

export interface EditChange {
  // In a conflict somebody else has changed the edits meanwhile; they stay as they are.
  readonly kind: 'done' | 'conflict';
  readonly now: EditList;
}

export async function fetchEdits(scanId: string, token: string): Promise<EditList> {
  const response = await request(`${scanPath(scanId)}/edits`, token, { limit_ms });
  return parseEdits(await response.json());
}

export async function saveEdits(
  scanId: string,
  token: string,
  { version, edits }: EditList,
): Promise<EditChange> {
  const body = JSON.stringify({ version, edits: edits.map(bodyOf) });
  const response = await request(`${scanPath(scanId)}/edits`, token, {
    limit_ms,
    method: 'PUT',
    headers,
    body,
    expected: [409],
  });
  if (response.ok) return { kind: 'done', now: parseEdits(await response.json()) };
  const text = await response.text();
  const now = conflictIn(text);
  if (!now) throw new ApiError(refusalOf(text, response.status), false, true);
  return { kind: 'conflict', now };
}

// The edits that a refusal has beside its error; null: it is another refusal.
export function conflictIn(body: string): EditList | null {
  try {
    const json: unknown = JSON.parse(body);
    return isRecord(json) && isRecord(json['edits']) ? parseEdits(json['edits']) : null;
  } catch {
    return null;
  }
}

// An edit that is not known would be lost by the next change: then nothing is read at all.
export function parseEdits(json: unknown): EditList {
  const version = isRecord(json) ? numberOf(json['version']) : null;
  if (!isRecord(json) || version === null || !Array.isArray(json['edits']))
    throw new ApiError(t.theServersAnswerCannotBeRead, false);
  return { version, edits: json['edits'].map(editOf) };
}

function bodyOf(edit: Edit): object {
  if (edit.kind === 'remove_floating')
    return { kind: edit.kind, smaller_than_m: edit.smaller_than_m };
  const { axes, low_m, high_m } = edit;
  return {
    kind: edit.kind,
    box: { axes: threeOf({ along: unit(axes.along), up: unit(axes.up) }), low_m, high_m },
  };
}

function editOf(json: unknown): Edit {
  const row = isRecord(json) ? json : {};
  const size = numberOf(row['smaller_than_m']);
  if (row['kind'] === 'remove_floating' && size !== null)
    return { kind: 'remove_floating', smaller_than_m: size };
  const box = boxOf(row['box']);
  const kind = (['keep_inside', 'remove_inside'] as const).find(
    (one: BoxKind) => one === row['kind'],
  );
  if (!kind || !box) throw new ApiError(t.theServersAnswerCannotBeRead, false);
  return { kind, ...box };
}

// The third direction follows from the others; of one that points the other way
// the bounds change places.
function boxOf(json: unknown): (Box & { readonly axes: Axes }) | null {
  if (!isRecord(json) || !Array.isArray(json['axes'])) return null;
  const [along, up, across] = json['axes'].map(placeOf);
  const [low_m, high_m] = [placeOf(json['low_m']), placeOf(json['high_m'])];
  if (!along || !up || !across || !low_m || !high_m) return null;
  if (dot(threeOf({ along, up })[2], across) >= 0) return { axes: { along, up }, low_m, high_m };
  return {
    axes: { along, up },
    low_m: [low_m[0], low_m[1], -high_m[2]],
    high_m: [high_m[0], high_m[1], -low_m[2]],
  };
}
