// What the page of the quality says in German.
import { expect, it, vi } from 'vitest';
import { parseRange, type FrameList, type FrameStatus } from '../connection/frames';
import { parseReport } from '../connection/scans';
import { t } from '../texts/texts';
import { dateText, frameShares, mapFacts, scanFacts } from './quality_facts';
import { doubtText, followedOf, imageText, percentText, qualityText } from './quality_text';

// Texts are in the language of the browser, which is asked when they are loaded:
// before the imports above.
vi.hoisted(() => {
  vi.stubGlobal('document', {});
  vi.stubGlobal('navigator', { languages: ['de-DE'] });
});

const reportOf = (frames: number, tracked: number, weak = 0, more: Record<string, unknown> = {}) =>
  parseReport({ frames, tracked_frames: tracked, weak_frames: weak, ...more });
type Run = readonly [FrameStatus, number];
const listOf = (...runs: readonly Run[]): FrameList => {
  const statuses = runs.flatMap(([status, frames]) => new Array<FrameStatus>(frames).fill(status));
  return {
    timestamps_s: statuses.map((_, i) => i / 10),
    statuses,
    reasons: statuses.map(() => ''),
  };
};
const ofRuns = (...runs: readonly Run[]): string => qualityText(followedOf(null, listOf(...runs)));
const ofReport = (...report: Parameters<typeof reportOf>): string =>
  qualityText(followedOf(reportOf(...report), null));

it('says in how many frames the camera was followed: in none, the only one, some and all', () => {
  expect(ofReport(0, 0)).toBe('Kein Bild wurde verarbeitet.');
  expect(ofReport(1, 0)).toBe('Die Kamera konnte im einzigen Bild nicht verfolgt werden.');
  expect(ofReport(24, 0)).toBe('Die Kamera konnte in keinem von 24 Bildern verfolgt werden.');
  expect(ofReport(1, 1)).toBe('Die Kamera wurde im einzigen Bild verfolgt.');
  expect(ofReport(2, 2)).toBe('Die Kamera wurde in allen 2 Bildern verfolgt.');
  expect(ofReport(1200, 1200)).toBe('Die Kamera wurde in allen 1.200 Bildern verfolgt.');
  expect(ofReport(10, 9)).toBe(
    'Die Kamera wurde in 9 von 10 Bildern verfolgt. In einem Bild war sie verloren.',
  );
  expect(ofReport(10, 8)).toBe(
    'Die Kamera wurde in 8 von 10 Bildern verfolgt. In 2 Bildern war sie verloren.',
  );
  expect(qualityText(followedOf(null, null))).toBe(
    'Wie gut die Kamera verfolgt wurde, ist in dieser Aufnahme nicht festgehalten.',
  );
});

it('says how many frames are doubtful, and for how long', () => {
  expect(ofReport(1, 1, 1)).toBe('Die Kamera wurde im einzigen Bild verfolgt; es ist unsicher.');
  expect(ofReport(50, 50, 1)).toBe(
    'Die Kamera wurde in allen 50 Bildern verfolgt; eines davon ist unsicher.',
  );
  expect(ofReport(50, 50, 2)).toBe(
    'Die Kamera wurde in allen 50 Bildern verfolgt; 2 davon sind unsicher.',
  );
  expect(ofRuns(['tracked', 5], ['weak', 1], ['tracked', 5])).toMatch(
    /; eines davon ist unsicher, für 0,1 s\.$/,
  );
  expect(ofRuns(['tracked', 5], ['weak', 8], ['tracked', 5])).toMatch(
    /; 8 davon sind unsicher, insgesamt für 0,8 s\.$/,
  );
});

it('says how often the camera was lost', () => {
  const lost = (times: number, ...after: readonly Run[]): string =>
    ofRuns(
      ['tracked', 5],
      ...Array.from({ length: times }, (): Run[] => [
        ['lost', 5],
        ['tracked', 20],
      ]).flat(),
      ...after,
    );
  expect(lost(1)).toMatch(/verfolgt\. Sie ging einmal verloren, für 0,5 s\.$/);
  expect(lost(2)).toContain('Sie ging zweimal verloren, insgesamt für 1,0 s.');
  expect(lost(3)).toContain('Sie ging dreimal verloren, insgesamt für 1,5 s.');
  expect(lost(12)).toContain('Sie ging zwölfmal verloren, insgesamt für 6,0 s.');
  expect(lost(13)).toContain('Sie ging 13-mal verloren, insgesamt für 6,5 s.');
  expect(lost(0, ['lost', 5])).toContain(
    'Sie ging einmal verloren, für 0,5 s, und wurde bis zum Ende nicht wiedergefunden.',
  );
  expect(lost(1, ['lost', 5])).toContain(
    'Sie ging zweimal verloren, insgesamt für 1,0 s, und wurde bis zum Ende nicht wiedergefunden.',
  );
});

it('says what became of frames that were not used', () => {
  const one = ofRuns(['tracked', 9], ['left_out', 1], ['refused', 1], ['damaged', 1]);
  expect(one).toContain('Ein Bild wurde ausgelassen, weil neuere kamen,');
  expect(one).toContain('Ein Bild wurde abgelehnt: Seine Zeit lag nicht nach der des vorigen.');
  expect(one).toContain('Ein Bild ist auf der Platte des Servers beschädigt.');
  const several = ofRuns(['tracked', 9], ['left_out', 2], ['refused', 3], ['damaged', 4]);
  expect(several).toContain('2 Bilder wurden ausgelassen, weil neuere kamen,');
  expect(several).toContain(
    '3 Bilder wurden abgelehnt: Ihre Zeit lag nicht nach der des jeweils vorigen.',
  );
  expect(several).toContain('4 Bilder sind auf der Platte des Servers beschädigt.');
});

it('says that the model is in parts, and what the server says as it says it', () => {
  const parts = (number: number): string => ofReport(9, 9, 0, { mapping: { parts: number } });
  expect(parts(1)).toBe('Die Kamera wurde in allen 9 Bildern verfolgt.');
  expect(parts(2)).toContain(
    'Das Modell besteht aus zwei Teilen, die nie verbunden wurden: Wie sie zueinander liegen, ist nicht bekannt.',
  );
  expect(parts(12)).toContain('aus zwölf Teilen,');
  expect(parts(13)).toContain('aus 13 Teilen,');
  expect(ofReport(9, 9, 0, { calibration_doubt: 'the calibration does not fit' })).toContain(
    'The calibration does not fit.',
  );
  expect(qualityText(followedOf(null, null, t.itCannotBeRead))).toMatch(
    /^Der Bericht der Aufnahme .* Er ist nicht lesbar\.$/,
  );
});

it('has text for a place of doubt and for what an image shows', () => {
  const doubtOf = (...runs: readonly Run[]): string =>
    doubtText(followedOf(null, listOf(['tracked', 5], ...runs, ['tracked', 5])).doubts![0]!);
  expect(doubtOf(['weak', 1])).toBe('Unsicher für 0,1 s: 1 Bild fast verloren, aber im Modell');
  expect(doubtOf(['lost', 10], ['weak', 2])).toBe(
    'Verloren für 1,0 s: 10 Bilder nicht im Modell; unsicher für 0,2 s: 2 Bilder fast verloren, aber im Modell',
  );
  expect(doubtOf(['lost', 1], ['tracked', 1], ['lost', 2])).toBe(
    'Zweimal verloren, insgesamt für 0,3 s: 3 Bilder nicht im Modell',
  );
  const depth = (header: string | null, valid_percent: number | null) => ({
    measured: parseRange(header),
    valid_percent,
  });
  expect(imageText(depth('0-0', 0), 0.01)).toBe(
    'In diesem Bild gibt es keine Tiefe, und das Farbbild ist fast schwarz.',
  );
  expect(imageText(depth('412-3981', 0), 0.5)).toBe(
    'In diesem Bild haben weniger als 1 % der Pixel eine Tiefe.',
  );
  expect(imageText(depth('412-3981', 87), 1)).toBe(
    'In diesem Bild haben 87 % der Pixel eine Tiefe, und das Farbbild ist fast weiß.',
  );
  expect(imageText(null, 0.01)).toBe('Dieses Bild ist fast schwarz.');
  expect(imageText(null, 0.5)).toBe('');
});

it('has German numbers and dates', () => {
  expect([0, 1, 0.5, 0.99999, 0.00001].map(percentText)).toEqual([
    '0 %',
    '100 %',
    '50,0 %',
    'mehr als 99,9 %',
    'weniger als 0,1 %',
  ]);
  expect(dateText(new Date(2026, 10, 27, 14, 5))).toBe('27. November 2026 um 14:05');
});

it('lists in German', () => {
  const followed = followedOf(
    reportOf(200, 151, 1),
    listOf(['tracked', 151], ['lost', 49], ['refused', 1]),
  );
  expect(frameShares(followed).map(({ label, value }) => `${label}: ${value}`)).toEqual([
    'Verfolgt: 75,0 %, 150 Bilder',
    'Unsicher: 0,5 %, 1 Bild',
    'Verloren: 24,5 %, 49 Bilder',
    'Nicht verwendet: dazu 1 Bild',
  ]);
  const facts = new Map(
    mapFacts(
      reportOf(9, 9, 0, { rotation_sigma_deg: 0.48, position_sigma_m: 0.02, mean_frame_ms: 33.3 }),
    ),
  );
  expect([facts.get('Richtung am Ende'), facts.get('Zeit für ein Bild')]).toEqual([
    '± 1,0°',
    'im Mittel 33 ms',
  ]);
  const [started, ended] = [new Date(2026, 10, 27, 14, 5), new Date(2026, 10, 27, 14, 7, 30)];
  const told = {
    id: 'a',
    title: '',
    tags: [],
    words: '',
    phase: 'finished',
    frameCount: 1,
    droppedCount: 0,
    imported: false,
    started,
    ended,
  } as const;
  expect(scanFacts(told, { length_m: 3.456, duration_s: 148 })).toEqual([
    ['Begonnen', '27. November 2026 um 14:05'],
    ['Zustand', 'Fertig, 2 min 30 s nach dem Beginn'],
    ['Bilder', '1 Bild'],
    ['Aufgezeichnet', '2 min 28 s nach der Uhr der Kamera'],
    ['Weg der Kamera', '3,46 m, solange sie verfolgt wurde'],
  ]);
});
