// States and quantities as texts that a person reads. One word per thing:
// scan, frame, submap, point.
import type { FrameEvent } from '../connection/events';
import type { MeshFinish, ScanExport } from '../connection/exports';
import type { Job } from '../connection/jobs';
import type { Progress } from '../connection/upload';
import { decimal, locale, t } from '../texts/texts';
import type { LiveScan } from './live_scan';
import { lengthText, roundedUpText, secondsText, withinText } from './quantities';

export type Tone = 'good' | 'busy' | 'warn' | 'bad' | 'quiet';

export interface StatusText {
  readonly text: string;
  readonly tone: Tone;
}

export function phaseText(phase: string, paused = false): StatusText {
  switch (phase) {
    case 'running':
      return paused ? { text: t.paused, tone: 'warn' } : { text: t.scanning, tone: 'good' };
    case 'finished':
      return { text: t.finished, tone: 'quiet' };
    case 'failed':
      return { text: t.failed, tone: 'bad' };
    case 'interrupted':
      return { text: t.interrupted, tone: 'warn' };
    default:
      return { text: t.unknown, tone: 'quiet' };
  }
}

export function jobText(job: Pick<Job, 'state' | 'stage' | 'done' | 'total'>): StatusText {
  switch (job.state) {
    case 'queued':
      return { text: t.waitingForItsTurn, tone: 'quiet' };
    case 'running':
      return { text: stageText(job), tone: 'busy' };
    case 'finished':
      return { text: t.finished, tone: 'quiet' };
    case 'failed':
      return { text: t.failed, tone: 'bad' };
    case 'cancelled':
      return { text: t.cancelled, tone: 'quiet' };
    default:
      return { text: t.unknown, tone: 'quiet' };
  }
}

export function sendingText(name: string, { share, waiting }: Progress): string {
  const done_percent = Math.floor(100 * share);
  return waiting ? t.sendingWaitingForTheServer(name, done_percent) : t.sending(name, done_percent);
}

// Empty when there is nothing to go on with. A browser may not open a file again by itself.
export function unfinishedText(names: readonly string[]): string {
  if (names.length === 0) return '';
  const all = names.join(', ');
  return names.length === 1 ? t.wasNotSentToTheEnd(all) : t.wereNotSentToTheEnd(all);
}

function stageText(job: Pick<Job, 'stage' | 'done' | 'total'>): string {
  const stage = job.stage || 'starting';
  const name = stage[0]!.toUpperCase() + stage.slice(1);
  return job.total > 0 ? t.stageOf(name, count(job.done), count(job.total)) : name;
}

export function trackingText(scan: LiveScan): StatusText {
  if (scan.tracking === 'none')
    return {
      text: scan.phase === 'running' ? t.waitingForTheFirstFrame : t.noFrameYet,
      tone: 'quiet',
    };
  if (scan.tracking === 'tracked') return { text: t.tracking, tone: 'good' };
  const word = scan.tracking === 'weak' ? t.weak : t.lost;
  const why = scan.trackingReason ? `${word}: ${scan.trackingReason}` : word;
  if (scan.tracking === 'weak' || scan.lostFor_s === null) return { text: why, tone: 'warn' };
  return { text: t.goBackToWhatWasSeen(why, secondsText(scan.lostFor_s)), tone: 'bad' };
}

// How well it is known where the camera is: twice the standard deviation. Null when there is
// nothing to say, or it would be old news.
export function positionText(scan: LiveScan): string | null {
  if (scan.positionSigma_m === null || scan.phase !== 'running' || scan.connection !== 'open')
    return null;
  return withinText(scan.positionSigma_m);
}

// Beside the last good view while the camera is lost, else empty.
export function wayBackLabel(frame: FrameEvent): string {
  if (frame.tracking !== 'lost' || !frame.lastTracked) return '';
  return t.goBackToThisViewSeen(secondsText(frame.timestamp_s - frame.lastTracked.timestamp_s));
}

// In the place of the images while the camera is lost. `withImage`: the
// view to go back to is shown.
export function lostText(withImage: boolean): string {
  return withImage ? t.cameraLostGoBackToThis : t.cameraLostItHasToGo;
}

// Of the image of that view.
export function wayBackCaption({ lostFor_s }: Pick<LiveScan, 'lostFor_s'>): string {
  return lostFor_s === null ? t.goBackHere : t.goBackHereSeenAgo(secondsText(lostFor_s));
}

const eventShown_s = 8; // by the camera's clock
const shownCorrection_m = 0.005; // less is not worth a word

// What happened to the map lately, empty when nothing did. That the camera is
// lost the mark says already.
export function eventText(scan: LiveScan): string {
  if (!scan.event || scan.timestamp_s - scan.event.timestamp_s > eventShown_s) return '';
  switch (scan.event.name) {
    case 'foundAgain':
      return t.foundAgain;
    case 'newPart':
      return t.aNewPartOfTheMap;
    case 'joined':
      return t.twoPartsOfTheMapAre;
    case 'loopClosed':
      return isCorrected(scan.event)
        ? t.loopClosedTheMapWasCorrected(roundedUpText(scan.event.correction_m))
        : t.loopClosedTheMapWasRight;
    case 'recalibrated':
      return isCorrected(scan.event)
        ? t.calibrationWasCorrectedMapToo(roundedUpText(scan.event.correction_m))
        : t.calibrationWasCorrectedMapWasRight;
    default:
      return '';
  }
}

const isCorrected = ({
  correction_m,
}: Pick<NonNullable<LiveScan['event']>, 'correction_m'>): boolean =>
  correction_m >= shownCorrection_m;

// While a scan runs; when it has ended the server has a text for that.
export function partsText(scan: LiveScan): string {
  if (scan.phase !== 'running' || scan.parts < 2) return '';
  return t.theMapIsInPartsThey(scan.parts);
}

export function connectionText(scan: LiveScan): StatusText {
  switch (scan.connection) {
    case 'connecting':
      return { text: t.connecting, tone: 'busy' };
    case 'open':
      return scan.snapshotComplete
        ? { text: t.connected, tone: 'good' }
        : { text: t.loading, tone: 'busy' };
    case 'waiting':
      return { text: t.reconnectingIn(secondsText(scan.retryIn_ms / 1000)), tone: 'warn' };
    case 'closed':
      if (scan.problem) return { text: t.closed, tone: 'bad' };
      return scan.framesDropped > 0
        ? { text: t.completeWithFramesLeftOut, tone: 'warn' }
        : { text: t.complete, tone: 'quiet' };
  }
}

// Of a scan in the list.
export function framesText({
  frameCount,
  droppedCount,
}: {
  readonly frameCount: number;
  readonly droppedCount: number;
}): string {
  if (droppedCount > 0) return t.ofFramesUsed(count(frameCount), count(frameCount + droppedCount));
  return framesNumber(frameCount);
}

export function framesNumber(frames: number): string {
  return frames === 1 ? t.n1Frame : t.framesCount(count(frames));
}

// Of a scan that has ended, what it lacks, empty when nothing.
export function leftOutText(scan: LiveScan): string {
  // Where the list of frames was counted, it says more exactly which ones are missing.
  if (scan.phase === 'running' || scan.framesDropped === 0 || scan.followed?.counts) return '';
  return t.ofFramesWereLeftOutSince(count(scan.framesDropped), count(scan.framesReceived));
}

// Of a running scan, what is in the model so far.
export function soFarText(scan: LiveScan): string {
  if (scan.phase !== 'running' || scan.framesProcessed === 0) return '';
  const soFar =
    scan.framesProcessed === 1 ? t.n1FrameSoFar : t.framesSoFar(count(scan.framesProcessed));
  if (scan.framesDropped === 0) return soFar;
  const dropped =
    scan.framesDropped === 1
      ? t.n1WasLeftOutSinceNewer
      : t.wereLeftOutSinceNewerOnes(count(scan.framesDropped));
  return `${soFar} ${dropped}`;
}

// Why the counts of points differ, empty while there is nothing to compare.
export function pointsText(scan: LiveScan): string {
  if (scan.points === 0) return '';
  if (scan.framesReceived === 0) return t.ofLargeCloudsSomePointsAre;
  const shown = t.shownArePointsOneForEvery(count(scan.points));
  if (!scan.report?.cloudPoints) return shown;
  const all = t.theCloudToDownloadHasAll(count(scan.report.cloudPoints));
  return scan.report.surfels
    ? t.theMapHasSurfelsThoseThat(shown, all, count(scan.report.surfels))
    : `${shown} ${all}`;
}

// What stands in the middle of an otherwise empty image, null when there is something to see.
export function emptyText(scan: LiveScan): string | null {
  if (scan.points > 0 || scan.triangles > 0) return null;
  if (scan.problem?.code === 'not_found') return t.thisScanDoesNotExistOr;
  if (scan.problem?.code === 'unauthorized') return t.theServerDoesNotAcceptThis;
  if (scan.problem) return scan.problem.message;
  if (scan.connection === 'waiting') return t.theServerCannotBeReachedTrying;
  if (scan.connection === 'connecting' || !scan.snapshotComplete) return t.loadingTheScan;
  if (scan.phase === 'running') return t.theFirstPointsAppearAsSoon;
  return t.thisScanHasNoPoints;
}

// With a capital letter and a full stop, where there is text.
export function sentence(text: string): string {
  const upper = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(upper) || upper === '' ? upper : `${upper}.`;
}

export function count(value: number): string {
  return value.toLocaleString(locale);
}

export function ago(then: Date, now: Date): string {
  const minutes = Math.floor((now.getTime() - then.getTime()) / 60_000);
  if (minutes < 1) return t.justNow;
  if (minutes < 60) return minutes === 1 ? t.aMinuteAgo : t.minutesAgo(minutes);
  const hours = Math.floor(minutes / 60);
  if (hours < 24) return hours === 1 ? t.anHourAgo : t.hoursAgo(hours);
  return then.toLocaleDateString(locale, { day: 'numeric', month: 'long', year: 'numeric' });
}

export function kindText(kind: string): string {
  switch (kind) {
    case 'mesh':
      return t.surface;
    case 'cloud':
      return t.points;
    case 'plan':
      return t.floorPlan;
    case 'path':
      return t.camera;
    case 'project':
      return t.forOtherPrograms;
    default:
      return t.other;
  }
}

export function sizeText(size_bytes: number): string {
  if (size_bytes < 1000) return t.bytesCount(size_bytes);
  if (size_bytes < 999_500) return `${Math.round(size_bytes / 1000)} kB`;
  return `${decimal(size_bytes / 1e6, size_bytes < 9_950_000 ? 1 : 0)} MB`;
}

// How a mesh was finished before it was written.
export function finishText({ simplify_um, triangles, fill_holes_mm, close }: MeshFinish): string {
  return [
    ...(simplify_um > 0 ? [t.simplifiedWithin(lengthText(simplify_um / 1e6))] : []),
    ...(triangles > 0 ? [t.atLeastTriangles(count(triangles))] : []),
    ...(close
      ? [t.allHolesClosed]
      : fill_holes_mm > 0
        ? [t.holesUpToFilled(lengthText(fill_holes_mm / 1000))]
        : []),
  ].join(', ');
}

// Behind the name of an export. `loaded_bytes`: how much of it has come, null
// when it is not being taken.
export function exportText(one: ScanExport, loaded_bytes: number | null): string {
  const share = (done: number): string => `${Math.floor(100 * Math.min(1, done))} %`;
  if (loaded_bytes !== null)
    return t.loadingShare(share(loaded_bytes / Math.max(1, one.size_bytes)));
  switch (one.state) {
    case 'ready':
      return sizeText(one.size_bytes);
    case 'running':
      return one.done > 0 ? t.beingMadeShare(share(one.done)) : t.beingMade;
    case 'queued':
      return one.words ? t.waitsForRoomOnTheDisk : t.waitsForItsTurn;
    case 'failed':
      return one.words ? t.failedBecause(one.words) : t.failed;
    case 'missing':
      return t.makeIt;
  }
}
