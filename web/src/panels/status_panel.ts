// What is known about the scan in numbers and words.
import type { LiveScan } from '../state/live_scan';
import type { Store } from '../state/store';
import { connectionWords, count, eventWords, partsWords, positionWords, trackingWords } from '../state/words';
import { element, setText, type Panel } from './dom';
import { statusMark } from './mark';

const refresh_ms = 500;

interface Row {
  readonly label: string;
  readonly value: (scan: LiveScan, picturesPerSecond: number) => string | null; // null: nothing to say
}

// No camera has seen it.
const isImported = (scan: LiveScan): boolean => scan.phase === 'finished' && scan.framesReceived === 0;

const rows: readonly Row[] = [
  { label: 'Points', value: (scan) => (scan.points > 0 || scan.triangles === 0 ? count(scan.points) : null) },
  { label: 'Triangles', value: (scan) => (scan.triangles > 0 && scan.mesh.state !== 'shown' ? count(scan.triangles) : null) },
  { label: 'Frames', value: (scan) => (isImported(scan) ? null : framesText(scan)) },
  { label: 'Submaps', value: (scan) => (scan.submaps > 1 ? count(scan.submaps) : null) },
  { label: 'Parts', value: (scan) => (scan.parts > 1 ? count(scan.parts) : null) },
  { label: 'Keyframes', value: (scan) => (scan.keyframes > 0 ? count(scan.keyframes) : null) },
  { label: 'Loops', value: (scan) => (scan.keyframes > 0 ? count(scan.loops) : null) },
  { label: 'Position', value: (scan) => positionWords(scan) },
  { label: 'Dropped', value: (scan) => (isImported(scan) ? null : count(scan.framesDropped)) },
  { label: 'Per frame', value: (scan) => (scan.frame_ms > 0 ? `${Math.round(scan.frame_ms)} ms` : null) },
  { label: 'Picture', value: (_, fps) => (fps > 0 ? `${fps} fps` : 'at rest') },
];

export function statusPanel(scan: Store<LiveScan, never>, picturesPerSecond: () => number): Panel {
  const tracking = statusMark();
  const connection = statusMark();
  const values = rows.map(() => element('dd'));
  const pairs = rows.map((row, i) => element('div', {}, element('dt', {}, row.label), values[i]!));
  const list = element('dl', { class: 'figures' }, ...pairs);
  const notice = element('p', { class: 'notice', role: 'status' });
  const node = element(
    'section',
    { class: 'card status', 'aria-label': 'Status' },
    element('div', { class: 'marks', role: 'status' }, tracking.element, connection.element),
    list,
    notice,
  );

  const show = (): void => {
    const state = scan.get();
    tracking.element.hidden = state.phase !== 'running' || state.connection !== 'open'; // else it would be old news
    tracking.show(trackingWords(state));
    connection.show(connectionWords(state));
    const fps = picturesPerSecond();
    rows.forEach((row, i) => {
      const value = row.value(state, fps);
      pairs[i]!.hidden = value === null;
      setText(values[i]!, value ?? '');
    });
    const words = noticeText(state);
    setText(notice, words);
    notice.hidden = words === '';
  };
  const unsubscribe = scan.subscribe(show);
  const timer = setInterval(show, refresh_ms);
  return {
    element: node,
    dispose() {
      unsubscribe();
      clearInterval(timer);
    },
  };
}

function framesText(scan: LiveScan): string {
  if (scan.framesReceived <= scan.framesProcessed) return count(scan.framesProcessed);
  return `${count(scan.framesProcessed)} of ${count(scan.framesReceived)}`;
}

function noticeText(scan: LiveScan): string {
  const words: string[] = [];
  if (scan.phase === 'running' && scan.connection === 'open') words.push(eventWords(scan), partsWords(scan));
  words.push(sentence(scan.phaseWords));
  if (scan.connection === 'waiting' && scan.connectionWords) words.push(`${sentence(scan.connectionWords)}`);
  if (scan.problem && (scan.points > 0 || scan.triangles > 0)) words.push(sentence(scan.problem.message));
  if (scan.failedChunks > 0) words.push(`${count(scan.failedChunks)} of the chunks could not be decoded.`);
  if (scan.full) words.push('The scan is larger than this page can show; some parts are left out.');
  return words.filter((part) => part !== '').join(' ');
}

function sentence(words: string): string {
  const upper = words.charAt(0).toUpperCase() + words.slice(1);
  return /[.!?]$/.test(upper) || upper === '' ? upper : `${upper}.`;
}
