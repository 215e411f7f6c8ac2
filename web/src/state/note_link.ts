// The chosen note as a query parameter, so that a link opens the scan with it. Pure functions.

// Returns 'note=…', or an empty text if none is chosen.
export function noteQuery(id: string | null): string {
  return id === null ? '' : `note=${id}`;
}

// Null: there is none, or what is there is no id.
export function readNote(query: string): string | null {
  const id = new URLSearchParams(query).get('note') ?? '';
  return /^[a-z0-9]{26}$/.test(id) ? id : null;
}
