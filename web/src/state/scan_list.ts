// Which scans of the list are shown, and in which order. Pure functions.
import type { ScanSummary } from '../connection/api';

export const sortNames = ['newest', 'oldest', 'title', 'frames'] as const;
export type SortName = (typeof sortNames)[number];

// Every word must be found in the title or a tag, whatever its case and accents.
export function found(scans: readonly ScanSummary[], query: string): ScanSummary[] {
  const wanted = plain(query).split(/\s+/).filter(Boolean);
  return scans.filter((scan) =>
    wanted.every((word) => [scan.title, ...scan.tags].some((text) => plain(text).includes(word))),
  );
}

// Those that have all of these tags.
export function tagged(scans: readonly ScanSummary[], tags: ReadonlySet<string>): ScanSummary[] {
  return scans.filter((scan) => [...tags].every((tag) => scan.tags.includes(tag)));
}

// All tags of these scans, in the order of a dictionary.
export function tagsOf(scans: readonly ScanSummary[]): string[] {
  return [...new Set(scans.flatMap((scan) => scan.tags))].sort((a, b) =>
    a.localeCompare(b, undefined, { numeric: true }),
  );
}

// The tags in what somebody has typed, each once.
export function tagsIn(text: string): string[] {
  return [
    ...new Set(
      text
        .split(/[,;]/)
        .map((tag) => tag.trim())
        .filter(Boolean),
    ),
  ];
}

// Equal ones stay newest first, as the server has them.
export function sorted(scans: readonly ScanSummary[], by: SortName): ScanSummary[] {
  switch (by) {
    case 'newest':
      return [...scans];
    case 'oldest':
      return [...scans].reverse();
    case 'title':
      return [...scans].sort((a, b) =>
        a.title.localeCompare(b.title, undefined, { numeric: true, sensitivity: 'base' }),
      );
    case 'frames':
      return [...scans].sort((a, b) => b.frameCount - a.frameCount);
  }
}

function plain(text: string): string {
  return text.normalize('NFKD').replace(/\p{M}/gu, '').toLowerCase();
}
