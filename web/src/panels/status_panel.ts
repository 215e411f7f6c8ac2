// How well the scan goes or went, in a sentence; behind "Details" the numbers.
import type { LiveScan } from '../state/live_scan';
import { qualityText } from '../state/quality_text';
import { millisecondsText } from '../state/quantities';
import { qualityHash } from '../state/route';
import type { Store } from '../state/store';
import {
  connectionText,
  count,
  eventText,
  leftOutText,
  partsText,
  pointsText,
  positionText,
  sentence,
  soFarText,
  trackingText,
} from '../state/text';
import { t } from '../texts/texts';
import { element, setText, type Panel } from './dom';
import { statusMark } from './mark';
import { scanTags } from './scan_tags';

const refresh_ms = 500;

interface Row {
  readonly label: string;
  // Null: there is nothing to say.
  readonly value: (scan: LiveScan, imagesPerSecond: number) => string | null;
}

// No camera has seen it.
const isImported = (scan: LiveScan): boolean =>
  scan.phase === 'finished' && scan.framesReceived === 0;

// The connection is no news any more.
const isQuiet = (scan: LiveScan): boolean => scan.connection === 'closed' && !scan.problem;

const rows: readonly Row[] = [
  {
    label: t.pointsShown,
    value: (scan) => (scan.points > 0 || scan.triangles === 0 ? count(scan.points) : null),
  },
  {
    label: t.pointsInFile,
    value: (scan) => (scan.report?.cloudPoints ? count(scan.report.cloudPoints) : null),
  },
  { label: t.triangles, value: trianglesText },
  { label: t.frames, value: (scan) => (isImported(scan) ? null : framesText(scan)) },
  { label: t.submaps, value: (scan) => (scan.submaps > 1 ? count(scan.submaps) : null) },
  { label: t.parts, value: (scan) => (scan.parts > 1 ? count(scan.parts) : null) },
  { label: t.keyframes, value: (scan) => (scan.keyframes > 0 ? count(scan.keyframes) : null) },
  { label: t.loops, value: (scan) => (scan.keyframes > 0 ? count(scan.loops) : null) },
  { label: t.position, value: (scan) => positionText(scan) },
  { label: t.dropped, value: (scan) => (isImported(scan) ? null : count(scan.framesDropped)) },
  {
    label: t.perFrame,
    value: (scan) =>
      scan.frame_ms > 0 && scan.phase === 'running' ? millisecondsText(scan.frame_ms) : null,
  },
  // A connection that is not quiet is seen above the list.
  { label: t.connection, value: (scan) => (isQuiet(scan) ? connectionText(scan).text : null) },
  { label: t.picture, value: (_, fps) => (fps > 0 ? `${fps} fps` : t.atRest) },
];

export function statusPanel(scan: Store<LiveScan, never>, imagesPerSecond: () => number): Panel {
  const tracking = statusMark();
  const connection = statusMark();
  const values = rows.map(() => element('dd'));
  const pairs = rows.map((row, i) => element('div', {}, element('dt', {}, row.label), values[i]!));
  const list = element('dl', { class: 'figures' }, ...pairs);
  const why = element('p', { class: 'why' });
  const details = element(
    'details',
    { class: 'details' },
    element('summary', {}, t.details),
    list,
    why,
  );
  // The summary of a running scan changes all the time, so that it is not read aloud when it does.
  const summary = element('p', { class: 'summary' });
  const quality = element(
    'a',
    { class: 'quality-link', href: qualityHash(scan.get().scanId), title: t.asAPageToPrintQ },
    t.moreAboutItsQuality,
  );
  const notice = element('p', { class: 'notice', role: 'status' });
  const tags = scanTags(scan);
  const node = element(
    'section',
    { class: 'card status', 'aria-label': t.status },
    element('div', { class: 'marks', role: 'status' }, tracking.element, connection.element),
    summary,
    notice,
    tags.element,
    details,
    quality,
  );

  const show = (): void => {
    const state = scan.get();
    // Of any other scan it would be old news.
    tracking.element.hidden = state.phase !== 'running' || state.connection !== 'open';
    tracking.show(trackingText(state));
    connection.element.hidden = isQuiet(state);
    connection.show(connectionText(state));
    const wellText = summaryText(state);
    setText(summary, wellText);
    summary.hidden = wellText === '';
    quality.hidden = state.phase === 'unknown';
    const fps = imagesPerSecond();
    rows.forEach((row, i) => {
      const value = row.value(state, fps);
      pairs[i]!.hidden = value === null;
      setText(values[i]!, value ?? '');
    });
    const noticeNow = noticeText(state);
    setText(notice, noticeNow);
    notice.hidden = noticeNow === '';
    setText(why, pointsText(state));
  };
  const unsubscribe = scan.subscribe(show);
  const timer = setInterval(show, refresh_ms);
  return {
    element: node,
    dispose() {
      unsubscribe();
      tags.dispose();
      clearInterval(timer);
    },
  };
}

function summaryText(scan: LiveScan): string {
  if (isImported(scan)) return t.thisModelWasImportedNoCamera;
  return scan.followed ? qualityText(scan.followed, scan.phaseText) : soFarText(scan);
}

// Of the surface that grows, or has been made.
function trianglesText(scan: LiveScan): string | null {
  const triangles = scan.mesh.state === 'shown' ? scan.mesh.triangles : scan.triangles;
  return triangles > 0 ? count(triangles) : null;
}

function framesText(scan: LiveScan): string {
  if (scan.framesReceived <= scan.framesProcessed) return count(scan.framesProcessed);
  return t.countOf(count(scan.framesProcessed), count(scan.framesReceived));
}

function noticeText(scan: LiveScan): string {
  const sentences: string[] = [];
  if (scan.phase === 'running' && scan.connection === 'open')
    sentences.push(eventText(scan), partsText(scan));
  sentences.push(sentence(scan.phaseText), leftOutText(scan));
  if (scan.connection === 'waiting' && scan.connectionText)
    sentences.push(`${sentence(scan.connectionText)}`);
  if (scan.problem && (scan.points > 0 || scan.triangles > 0))
    sentences.push(sentence(scan.problem.message));
  if (scan.failedChunks > 0) sentences.push(t.ofTheChunksCouldNotBe(count(scan.failedChunks)));
  if (scan.old) sentences.push(t.someOfWhatIsShownIs);
  if (scan.full) sentences.push(t.theScanIsLargerThanThis);
  return sentences.filter((part) => part !== '').join(' ');
}
