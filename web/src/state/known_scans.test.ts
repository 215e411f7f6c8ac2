import { expect, test } from 'vitest';
import type { ScanSummary } from '../connection/api';
import { listedScan } from '../connection/listed_scan';
import { KnownScans } from './known_scans';

// The scan of a day of January.
const scan = (day: number): ScanSummary => listedScan(`scan${day}`, new Date(2026, 0, day));
const idsOf = ({ all }: KnownScans): string[] => all.map(({ id }) => id);

test('without older ones the page knows what the server tells just now, and nothing else', () => {
  const known = new KnownScans();
  known.takeNewest({ scans: [scan(4), scan(3)], more: true });
  known.takeNewest({ scans: [scan(3)], more: false });
  expect([idsOf(known), known.more]).toEqual([['scan3'], false]);
});

test('older ones stay while the newest are asked for again, which does not know of more', () => {
  const known = new KnownScans();
  known.takeNewest({ scans: [scan(4), scan(3)], more: true });
  known.takeOlder({ scans: [scan(2), scan(1)], more: false });
  known.takeNewest({ scans: [scan(5), scan(4)], more: true });
  expect([idsOf(known), known.more]).toEqual([
    ['scan5', 'scan4', 'scan3', 'scan2', 'scan1'],
    false,
  ]);
});
