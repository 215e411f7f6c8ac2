// How well a scan went, in sentences: from what its report and the list of its frames say, and
// nothing beyond. Pure functions.
import type { DepthImage, DepthRange, FrameList } from '../connection/frames';
import type { Report } from '../connection/scans';
import { decimal, t } from '../texts/texts';
import { durationText, roundedUpText } from './quantities';
import {
  countsOf,
  doubtsIn,
  stretchesOf,
  type Doubt,
  type FrameCounts,
  type Stretch,
} from './stretches';
import { count, framesNumber, sentence } from './text';

export interface Followed {
  readonly frames: number | null; // that were processed; null: nobody knows
  readonly tracked: number | null; // of these; weak ones included
  readonly weak: number | null;
  readonly torn: number; // frames of which only a part arrived; 0 where nobody says
  readonly counts: FrameCounts | null; // of all that were sent; null: the list cannot be had
  readonly stretches: readonly Stretch[] | null;
  readonly doubts: readonly Doubt[] | null;
  readonly parts: number; // of the model; 1 where nobody says
  readonly expectedPathError_m: number | null; // null: the report does not say
  readonly calibrationDoubt: string;
  readonly cameraCorrection: string;
  // Why the scan's report could not be loaded, a sentence; empty when it was, or there is none.
  readonly unread: string;
}

// `report`: null when the scan has none. `unread`: it may have one, but that could not be loaded.
export function followedOf(report: Report | null, list: FrameList | null, unread = ''): Followed {
  const counts = list && countsOf(list.statuses);
  const stretches = list && stretchesOf(list);
  // A list whose frames are unknown says less than the report, which has sums.
  const listed =
    counts && counts.unknown === 0 && counts.tracked + counts.weak + counts.lost > 0
      ? counts
      : null;
  return {
    frames:
      report?.frames ??
      (counts ? counts.tracked + counts.weak + counts.lost + counts.unknown : null),
    tracked: report?.trackedFrames ?? (listed ? listed.tracked + listed.weak : null),
    weak: report?.weakFrames ?? listed?.weak ?? null,
    torn: report?.tornFrames ?? 0,
    counts,
    stretches: listed && stretches,
    doubts: listed && stretches && doubtsIn(stretches),
    parts: report?.mapping['parts'] ?? 1,
    expectedPathError_m: report?.expectedPathError_m ?? null,
    calibrationDoubt: report?.calibrationDoubt ?? '',
    cameraCorrection: report?.cameraCorrection ?? '',
    unread,
  };
}

const saysParts = /could not be joined/; // the server, of the map

// `said`: what the page says beside it, which is not repeated.
export function qualityText(followed: Followed, said = ''): string {
  const { parts, calibrationDoubt, cameraCorrection } = followed;
  return [
    followedText(followed),
    lostText(followed),
    expectedText(followed),
    tornText(followed),
    unusedText(followed.counts),
    unreadText(followed),
    parts > 1 && !saysParts.test(said) ? t.theModelIsInParts(count(parts)) : '',
    ...[calibrationDoubt, cameraCorrection]
      .filter((part) => part !== '' && !said.includes(part))
      .map(sentence),
  ]
    .filter((part) => part !== '')
    .join(' ');
}

function followedText({ frames, tracked, weak, doubts, unread }: Followed): string {
  if (frames === null || tracked === null)
    return unread !== '' ? '' : t.howWellTheCameraWasFollowed;
  if (frames === 0) return t.noFrameWasProcessed;
  if (tracked === 0)
    return frames === 1
      ? t.theCameraCouldNotBeFollowedInTheOnly
      : t.theCameraCouldNotBeFollowedInAny(count(frames));
  const followed =
    tracked < frames
      ? t.theCameraWasFollowedInOf(count(tracked), count(frames))
      : frames === 1
        ? t.theCameraWasFollowedInTheOnly
        : t.theCameraWasFollowedInAll(count(frames));
  if (!weak) return sentence(followed);
  return sentence(`${followed}; ${frames === 1 ? t.itIsDoubtful : weakText(weak, doubts)}`);
}

// Behind how many frames were followed.
function weakText(weak: number, doubts: readonly Doubt[] | null): string {
  const long_s = sumOf(doubts, ({ weak_s }) => weak_s);
  if (weak === 1)
    return long_s > 0 ? t.oneOfThemIsDoubtfulFor(durationText(long_s)) : t.oneOfThemIsDoubtful;
  return long_s > 0
    ? t.ofThemAreDoubtfulFor(count(weak), durationText(long_s))
    : t.ofThemAreDoubtful(count(weak));
}

function lostText({ frames, tracked, doubts, stretches }: Followed): string {
  if (!frames || !tracked || tracked === frames) return '';
  const losses = sumOf(doubts, (doubt) => doubt.losses);
  if (losses === 0)
    return frames - tracked === 1
      ? t.itWasLostInOneFrame
      : t.itWasLostInFrames(count(frames - tracked));
  const long = durationText(sumOf(doubts, ({ lost_s }) => lost_s));
  const isLostAtTheEnd =
    stretches?.filter(({ follow }) => follow !== 'gap').at(-1)?.follow === 'lost';
  if (losses === 1) return isLostAtTheEnd ? t.itWasLostOnceToTheEnd(long) : t.itWasLostOnce(long);
  return isLostAtTheEnd
    ? t.itWasLostTimesToTheEnd(count(losses), long)
    : t.itWasLostTimes(count(losses), long);
}

function expectedText({ expectedPathError_m, tracked }: Followed): string {
  return expectedPathError_m !== null && tracked
    ? t.itsPathShouldBeRightTo(roundedUpText(expectedPathError_m))
    : '';
}

function unreadText({ unread }: Followed): string {
  return unread === '' ? '' : t.theScansReportCouldNotBe(unread);
}

function tornText({ torn }: Followed): string {
  if (torn === 0) return '';
  return torn === 1 ? t.oneFrameArrivedIncompletely : t.framesArrivedIncompletely(count(torn));
}

function unusedText(counts: FrameCounts | null): string {
  if (!counts) return '';
  const told = (frames: number, one: string, several: (frames: string) => string): string =>
    frames === 0 ? '' : frames === 1 ? one : several(count(frames));
  return [
    told(counts.left_out, t.oneFrameWasLeftOutSince, t.framesWereLeftOutSinceNewer),
    told(counts.refused, t.oneFrameWasRefusedItsTime, t.framesWereRefusedTheirTimes),
    told(counts.damaged, t.oneFrameIsDamagedOnThe, t.framesAreDamagedOnTheServers),
  ]
    .filter((part) => part !== '')
    .join(' ');
}

// Of one place in the list of doubts.
export function doubtText({ weak, lost, weak_s, lost_s, losses }: Doubt): string {
  const [long, frames] = [durationText(lost_s), framesNumber(lost)];
  return [
    ...(lost > 0
      ? [
          losses > 1
            ? t.lostTimesNotInTheModel(count(losses), long, frames)
            : t.lostForNotInTheModel(long, frames),
        ]
      : []),
    ...(weak > 0 ? [t.doubtfulForNearlyLost(durationText(weak_s), framesNumber(weak))] : []),
  ]
    .join('; ')
    .replace(/^./, (letter) => letter.toUpperCase());
}

// What the images of a frame show by themselves; empty when nothing is striking.
export function imageText(
  depth: Pick<DepthImage, 'measured' | 'valid_percent'> | null,
  brightness: number | null,
): string {
  const seen =
    depth === null || depth.valid_percent === null
      ? ''
      : depthText(depth.measured, depth.valid_percent);
  if (brightness !== null && brightness < 0.1)
    return sentence(seen ? t.andTheImageIsNearlyBlack(seen) : t.inThisFrameTheImageIsNearlyBlack);
  if (brightness !== null && brightness > 0.95)
    return sentence(seen ? t.andTheImageIsNearlyWhite(seen) : t.inThisFrameTheImageIsNearlyWhite);
  return sentence(seen);
}

// The server cuts the fraction off: 0 % may be a few pixels, which have a range.
function depthText({ to_mm }: DepthRange, valid_percent: number): string {
  if (valid_percent >= 1) return t.inThisFramePercentOfThePixels(valid_percent);
  return to_mm === 0 ? t.inThisFrameThereIsNoDepth : t.inThisFrameLessThan1Percent;
}

function sumOf(doubts: readonly Doubt[] | null, of: (doubt: Doubt) => number): number {
  return doubts?.reduce((sum, doubt) => sum + of(doubt), 0) ?? 0;
}

// A share that is not all is never 100 %, one that is not nothing never 0 %.
export function percentText(share: number): string {
  const percent = 100 * share;
  if (percent > 0 && percent < 0.1) return t.lessThan(`${decimal(0.1, 1)} %`);
  if (percent < 100 && percent > 99.9) return t.moreThan(`${decimal(99.9, 1)} %`);
  return `${percent === 0 || percent === 100 ? percent : decimal(percent, 1)} %`;
}
