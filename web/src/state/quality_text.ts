// How well a scan went, in sentences: from what its report and the list of its frames say, and nothing beyond. Pure functions.
import type { DepthImage, DepthRange, FrameList } from '../connection/frames';
import type { Report } from '../connection/scans';
import { countsOf, doubtsIn, stretchesOf, type Doubt, type FrameCounts, type Stretch } from './stretches';
import { count, sentence } from './text';

export interface Followed {
  readonly frames: number | null; // that were processed; null: nobody knows
  readonly tracked: number | null; // of these; weak ones included
  readonly weak: number | null;
  readonly counts: FrameCounts | null; // of all that were sent; null: the list cannot be had
  readonly stretches: readonly Stretch[] | null;
  readonly doubts: readonly Doubt[] | null;
  readonly parts: number; // of the model; 1 where nobody says
  readonly calibrationDoubt: string;
  readonly cameraCorrection: string;
  readonly unread: string; // why the scan's report could not be loaded, a sentence; empty when it was, or there is none
}

// `report`: null when the scan has none. `unread`: it may have one, but that could not be loaded.
export function followedOf(report: Report | null, list: FrameList | null, unread = ''): Followed {
  const counts = list && countsOf(list.statuses);
  const stretches = list && stretchesOf(list);
  // A list whose frames are unknown says less than the report, which has sums.
  const listed = counts && counts.unknown === 0 && counts.tracked + counts.weak + counts.lost > 0 ? counts : null;
  return {
    frames: report?.frames ?? (counts ? counts.tracked + counts.weak + counts.lost + counts.unknown : null),
    tracked: report?.trackedFrames ?? (listed ? listed.tracked + listed.weak : null),
    weak: report?.weakFrames ?? listed?.weak ?? null,
    counts,
    stretches: listed && stretches,
    doubts: listed && stretches && doubtsIn(stretches),
    parts: report?.mapping['parts'] ?? 1,
    calibrationDoubt: report?.calibrationDoubt ?? '',
    cameraCorrection: report?.cameraCorrection ?? '',
    unread,
  };
}

const numberNames = ['no', 'one', 'two', 'three', 'four', 'five', 'six', 'seven', 'eight', 'nine', 'ten', 'eleven', 'twelve'];

// `said`: what the page says beside it, which is not repeated.
export function qualityText(followed: Followed, said = ''): string {
  const { parts, calibrationDoubt, cameraCorrection } = followed;
  return [
    followedText(followed),
    lostText(followed),
    unusedText(followed.counts),
    unreadText(followed),
    parts > 1 && !said.includes('could not be joined')
      ? `The model is in ${name(parts)} parts that were never joined: where they lie to each other is not known.`
      : '',
    ...[calibrationDoubt, cameraCorrection].filter((part) => part !== '' && !said.includes(part)).map(sentence),
  ]
    .filter((part) => part !== '')
    .join(' ');
}

function followedText({ frames, tracked, weak, doubts, unread }: Followed): string {
  if (frames === null || tracked === null) return unread !== '' ? '' : 'How well the camera was followed is not recorded in this scan.';
  if (frames === 0) return 'No frame was processed.';
  if (tracked === 0)
    return frames === 1
      ? 'The camera could not be followed in the only frame.'
      : `The camera could not be followed in any of ${count(frames)} frames.`;
  const share =
    tracked < frames
      ? `in ${count(tracked)} of ${count(frames)} frames`
      : frames === 1
        ? 'in the only frame'
        : `in all of ${count(frames)} frames`;
  return `The camera was followed ${share}${weakText(weak ?? 0, doubts)}.`;
}

// Behind how many frames were followed.
function weakText(weak: number, doubts: readonly Doubt[] | null): string {
  if (weak === 0) return '';
  const long_s = sumOf(doubts, ({ weak_s }) => weak_s);
  const many = weak === 1 ? 'one of them is doubtful' : `${count(weak)} of them are doubtful`;
  return `; ${many}${long_s > 0 ? `, for ${durationText(long_s)}${weak === 1 ? '' : ' in all'}` : ''}`;
}

function lostText({ frames, tracked, doubts, stretches }: Followed): string {
  if (!frames || !tracked || tracked === frames) return '';
  const losses = sumOf(doubts, (doubt) => doubt.losses);
  if (losses === 0) return `It was lost in ${frames - tracked === 1 ? 'one frame' : `${count(frames - tracked)} frames`}.`;
  const times = losses === 1 ? 'once' : losses === 2 ? 'twice' : `${name(losses)} times`;
  const long = `for ${durationText(sumOf(doubts, ({ lost_s }) => lost_s))}${losses === 1 ? '' : ' in all'}`;
  return `It was lost ${times}, ${long}${stretches?.filter(({ follow }) => follow !== 'gap').at(-1)?.follow === 'lost' ? ', and was not found again before the end' : ''}.`;
}

function unreadText({ unread }: Followed): string {
  if (unread === '') return '';
  return `The scan’s report could not be loaded, so that what it says is missing here: how well the camera was followed, whether the model is in parts, and whether the calibration fits. ${unread}`;
}

function unusedText(counts: FrameCounts | null): string {
  if (!counts) return '';
  const { left_out, refused, damaged } = counts;
  const frames = (number: number): string => (number === 1 ? 'One frame' : `${count(number)} frames`);
  return [
    left_out > 0
      ? `${frames(left_out)} ${left_out === 1 ? 'was' : 'were'} left out, since newer ones were there before the server had time.`
      : '',
    refused > 0
      ? `${frames(refused)} ${refused === 1 ? 'was refused: its time was' : 'were refused: their times were'} not after the one before.`
      : '',
    damaged > 0 ? `${frames(damaged)} ${damaged === 1 ? 'is' : 'are'} damaged on the server’s disk.` : '',
  ]
    .filter((part) => part !== '')
    .join(' ');
}

// Of one place in the list of doubts.
export function doubtText({ weak, lost, weak_s, lost_s, losses }: Doubt): string {
  const frames = (number: number): string => `${count(number)} ${number === 1 ? 'frame' : 'frames'}`;
  const often =
    losses > 1 ? `${losses === 2 ? 'twice' : `${name(losses)} times`}, for ${durationText(lost_s)} in all` : `for ${durationText(lost_s)}`;
  return [
    ...(lost > 0 ? [`lost ${often}: ${frames(lost)} not in the model`] : []),
    ...(weak > 0 ? [`doubtful for ${durationText(weak_s)}: ${frames(weak)} nearly lost, but in the model`] : []),
  ]
    .join('; ')
    .replace(/^./, (letter) => letter.toUpperCase());
}

// What the images of a frame show by themselves; empty when nothing is striking.
export function imageText(depth: Pick<DepthImage, 'measured' | 'valid_percent'> | null, brightness: number | null): string {
  const facts = [
    ...(depth === null || depth.valid_percent === null ? [] : [depthText(depth.measured, depth.valid_percent)]),
    ...(brightness !== null && brightness < 0.1 ? ['the image is nearly black'] : []),
    ...(brightness !== null && brightness > 0.95 ? ['the image is nearly white'] : []),
  ];
  return facts.length === 0 ? '' : sentence(`in this frame ${facts.join(', and ')}`);
}

// The server cuts the fraction off: 0 % may be a few pixels, which have a range.
function depthText({ to_mm }: DepthRange, valid_percent: number): string {
  if (valid_percent >= 1) return `${valid_percent} % of the pixels have depth`;
  return to_mm === 0 ? 'there is no depth' : 'less than 1 % of the pixels have depth';
}

function sumOf(doubts: readonly Doubt[] | null, of: (doubt: Doubt) => number): number {
  return doubts?.reduce((sum, doubt) => sum + of(doubt), 0) ?? 0;
}

const name = (number: number): string => numberNames[number] ?? count(number);

export function durationText(duration_s: number): string {
  if (duration_s < 0.05) return 'less than 0.1 s';
  if (duration_s < 9.95) return `${duration_s.toFixed(1)} s`;
  const whole_s = Math.round(duration_s);
  if (whole_s < 60) return `${whole_s} s`;
  const [hours, minutes, seconds] = [Math.floor(whole_s / 3600), Math.floor(whole_s / 60) % 60, whole_s % 60];
  return hours > 0 ? `${hours} h ${minutes} min` : `${minutes} min ${seconds} s`;
}

// "1:02.3"
export function clockText(at_s: number): string {
  const tenths = Math.round(10 * at_s);
  return `${Math.floor(tenths / 600)}:${String(Math.floor(tenths / 10) % 60).padStart(2, '0')}.${tenths % 10}`;
}

// A share that is not all is never 100 %, one that is not nothing never 0 %.
export function percentText(share: number): string {
  const percent = 100 * share;
  if (percent > 0 && percent < 0.1) return 'less than 0.1 %';
  if (percent < 100 && percent > 99.9) return 'more than 99.9 %';
  return `${percent === 0 || percent === 100 ? percent : percent.toFixed(1)} %`;
}
