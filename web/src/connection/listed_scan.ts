import type { ScanSummary } from './api';

/** A finished scan as the list has it, for tests. */
export const listedScan = (id: string, started: Date): ScanSummary => ({
  id,
  title: id,
  tags: [],
  phase: 'finished',
  words: '',
  frameCount: 1,
  droppedCount: 0,
  imported: false,
  started,
  ended: null,
});
