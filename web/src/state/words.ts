// States and quantities in the words that a person reads. One word per thing: scan, frame, submap, point.
import type { FrameEvent } from '../connection/events';
import type { MeshFinish, ScanExport } from '../connection/exports';
import type { Job } from '../connection/jobs';
import type { Progress } from '../connection/upload';
import type { LiveScan } from './live_scan';

export type Tone = 'good' | 'busy' | 'warn' | 'bad' | 'quiet';

export interface Words {
  readonly text: string;
  readonly tone: Tone;
}

export function phaseWords(phase: string): Words {
  switch (phase) {
    case 'running':
      return { text: 'Scanning', tone: 'good' };
    case 'finished':
      return { text: 'Finished', tone: 'quiet' };
    case 'failed':
      return { text: 'Failed', tone: 'bad' };
    case 'interrupted':
      return { text: 'Interrupted', tone: 'warn' };
    default:
      return { text: 'Unknown', tone: 'quiet' };
  }
}

export function jobWords(job: Pick<Job, 'state' | 'stage' | 'done' | 'total'>): Words {
  switch (job.state) {
    case 'queued':
      return { text: 'Waiting for its turn', tone: 'quiet' };
    case 'running':
      return { text: stageWords(job), tone: 'busy' };
    case 'finished':
      return { text: 'Finished', tone: 'quiet' };
    case 'failed':
      return { text: 'Failed', tone: 'bad' };
    case 'cancelled':
      return { text: 'Cancelled', tone: 'quiet' };
    default:
      return { text: 'Unknown', tone: 'quiet' };
  }
}

export function sendingWords(name: string, { share, waiting }: Progress): string {
  return `Sending ${name}: ${Math.floor(100 * share)} %${waiting ? ', waiting for the server' : ''}`;
}

// Empty when there is nothing to go on with. A browser may not open a file again by itself.
export function unfinishedWords(names: readonly string[]): string {
  if (names.length === 0) return '';
  const [verb, what] = names.length === 1 ? ['was', 'it again and it goes'] : ['were', 'them again and they go'];
  return `${names.join(', ')} ${verb} not sent to the end. Add ${what} on from there.`;
}

function stageWords(job: Pick<Job, 'stage' | 'done' | 'total'>): string {
  const stage = job.stage || 'starting';
  const words = stage[0]!.toUpperCase() + stage.slice(1);
  return job.total > 0 ? `${words} ${count(job.done)} of ${count(job.total)}` : words;
}

export function trackingWords(scan: LiveScan): Words {
  if (scan.tracking === 'none') return { text: scan.phase === 'running' ? 'Waiting for the first frame' : 'No frame yet', tone: 'quiet' };
  if (scan.tracking === 'tracked') return { text: 'Tracking', tone: 'good' };
  const word = scan.tracking === 'weak' ? 'Weak' : 'Lost';
  const why = scan.trackingReason ? `${word}: ${scan.trackingReason}` : word;
  if (scan.tracking === 'weak' || scan.lostFor_s === null) return { text: why, tone: 'warn' };
  return { text: `${why} – go back to what was seen ${seconds(1000 * scan.lostFor_s)} ago`, tone: 'bad' };
}

// How well it is known where the camera is: twice the standard deviation. Null when there is nothing to say, or it would be old news.
export function positionWords(scan: LiveScan): string | null {
  if (scan.positionSigma_m === null || scan.phase !== 'running' || scan.connection !== 'open') return null;
  return withinWords(scan.positionSigma_m);
}

// Twice a standard deviation.
export function withinWords(sigma_m: number): string {
  const within_mm = 2000 * sigma_m;
  return within_mm < 10 ? `± ${Math.max(1, Math.round(within_mm))} mm` : `± ${Math.round(within_mm / 10)} cm`;
}

// Beside the last good view while the camera is lost, else empty.
export function wayBackLabel(frame: FrameEvent): string {
  if (frame.tracking !== 'lost' || !frame.lastTracked) return '';
  return `Go back to this view, seen ${seconds(1000 * (frame.timestamp_s - frame.lastTracked.timestamp_s))} ago`;
}

// In the place of the images while the camera is lost. `withImage`: the view to go back to is shown.
export function lostWords(withImage: boolean): string {
  return withImage ? 'Camera lost. Go back to this view:' : 'Camera lost. It has to go back to the red place.';
}

// Of the image of that view.
export function wayBackCaption({ lostFor_s }: Pick<LiveScan, 'lostFor_s'>): string {
  return lostFor_s === null ? 'Go back here' : `Go back here, seen ${seconds(1000 * lostFor_s)} ago`;
}

const eventShown_s = 8; // by the camera's clock
const shownCorrection_m = 0.005; // less is not worth a word

// What happened to the map lately, empty when nothing did. That the camera is lost the mark says already.
export function eventWords(scan: LiveScan): string {
  if (!scan.event || scan.timestamp_s - scan.event.timestamp_s > eventShown_s) return '';
  switch (scan.event.name) {
    case 'foundAgain':
      return 'Found again.';
    case 'newPart':
      return 'A new part of the map begins.';
    case 'joined':
      return 'Two parts of the map are joined.';
    case 'loopClosed':
      return `Loop closed: the map was ${correctionWords(scan.event.correction_m)}.`;
    case 'recalibrated':
      return `The camera’s calibration was off and is corrected: the map was ${correctionWords(scan.event.correction_m)}.`;
    default:
      return '';
  }
}

function correctionWords(correction_m: number): string {
  return correction_m < shownCorrection_m ? 'right' : `corrected by up to ${Math.round(100 * correction_m)} cm`;
}

// While a scan runs; when it has ended the server has words for that.
export function partsWords(scan: LiveScan): string {
  if (scan.phase !== 'running' || scan.parts < 2) return '';
  return `The map is in ${scan.parts} parts: they will be joined when the camera sees both.`;
}

export function connectionWords(scan: LiveScan): Words {
  switch (scan.connection) {
    case 'connecting':
      return { text: 'Connecting', tone: 'busy' };
    case 'open':
      return scan.snapshotComplete ? { text: 'Connected', tone: 'good' } : { text: 'Loading', tone: 'busy' };
    case 'waiting':
      return { text: `Reconnecting in ${seconds(scan.retryIn_ms)}`, tone: 'warn' };
    case 'closed':
      if (scan.problem) return { text: 'Closed', tone: 'bad' };
      return scan.framesDropped > 0 ? { text: 'Complete, with frames left out', tone: 'warn' } : { text: 'Complete', tone: 'quiet' };
  }
}

// Of a scan in the list.
export function framesWords({ frameCount, droppedCount }: { readonly frameCount: number; readonly droppedCount: number }): string {
  const frames = frameCount === 1 && droppedCount === 0 ? 'frame' : 'frames';
  return droppedCount === 0 ? `${count(frameCount)} ${frames}` : `${count(frameCount)} of ${count(frameCount + droppedCount)} ${frames} used`;
}

// Of a scan that has ended, what it lacks, empty when nothing.
export function leftOutWords(scan: LiveScan): string {
  if (scan.phase === 'running' || scan.framesDropped === 0 || scan.followed?.counts) return ''; // that knows which ones
  return `${count(scan.framesDropped)} of ${count(scan.framesReceived)} frames were left out, since newer ones were there before the server had time for them.`;
}

// Of a running scan, what is in the model so far.
export function soFarWords(scan: LiveScan): string {
  if (scan.phase !== 'running' || scan.framesProcessed === 0) return '';
  const dropped = scan.framesDropped > 0 ? ` ${count(scan.framesDropped)} ${scan.framesDropped === 1 ? 'was' : 'were'} left out, since newer ones were there before the server had time.` : '';
  return `${count(scan.framesProcessed)} ${scan.framesProcessed === 1 ? 'frame' : 'frames'} so far.${dropped}`;
}

// Why the counts of points differ, empty while there is nothing to compare.
export function pointsWords(scan: LiveScan): string {
  if (scan.points === 0) return '';
  if (scan.framesReceived === 0) return 'Of large clouds some points are shown; downloads have all.';
  const shown = `Shown are ${count(scan.points)} points, one for every 5 mm.`;
  if (!scan.report?.cloudPoints) return shown;
  const more = scan.report.surfels ? ` The map has ${count(scan.report.surfels)} surfels; those that were seen only now and then are in neither.` : '';
  return `${shown} The cloud to download has all ${count(scan.report.cloudPoints)}.${more}`;
}

// What stands in the middle of an otherwise empty picture, null when there is something to see.
export function emptyWords(scan: LiveScan): string | null {
  if (scan.points > 0 || scan.triangles > 0) return null;
  if (scan.problem?.code === 'not_found') return 'This scan does not exist, or no longer.';
  if (scan.problem?.code === 'unauthorized') return 'The server does not accept this access token.';
  if (scan.problem) return scan.problem.message;
  if (scan.connection === 'waiting') return 'The server cannot be reached. Trying again.';
  if (scan.connection === 'connecting' || !scan.snapshotComplete) return 'Loading the scan.';
  if (scan.phase === 'running') return 'The first points appear as soon as a surface has been seen often enough.';
  return 'This scan has no points.';
}

// With a capital letter and a full stop, where there are words.
export function sentence(words: string): string {
  const upper = words.charAt(0).toUpperCase() + words.slice(1);
  return /[.!?]$/.test(upper) || upper === '' ? upper : `${upper}.`;
}

export function count(value: number): string {
  return value.toLocaleString('en-GB');
}

export function seconds(duration_ms: number): string {
  return duration_ms < 1000 ? 'less than a second' : `${Math.round(duration_ms / 1000)} s`;
}

export function ago(then: Date, now: Date): string {
  const minutes = Math.floor((now.getTime() - then.getTime()) / 60_000);
  if (minutes < 1) return 'just now';
  if (minutes < 60) return minutes === 1 ? 'a minute ago' : `${minutes} minutes ago`;
  const hours = Math.floor(minutes / 60);
  if (hours < 24) return hours === 1 ? 'an hour ago' : `${hours} hours ago`;
  return then.toLocaleDateString('en-GB', { day: 'numeric', month: 'long', year: 'numeric' });
}

export function kindWords(kind: string): string {
  switch (kind) {
    case 'mesh':
      return 'Surface';
    case 'cloud':
      return 'Points';
    case 'path':
      return 'Camera';
    case 'project':
      return 'For other programs';
    default:
      return 'Other';
  }
}

export function sizeWords(size_bytes: number): string {
  if (size_bytes < 1000) return `${size_bytes} bytes`;
  if (size_bytes < 999_500) return `${Math.round(size_bytes / 1000)} kB`;
  return `${(size_bytes / 1e6).toFixed(size_bytes < 9_950_000 ? 1 : 0)} MB`;
}

// How a mesh was finished before it was written.
export function finishWords({ simplify_um, triangles, fill_holes_mm, close }: MeshFinish): string {
  return [
    ...(simplify_um > 0 ? [`simplified within ${simplify_um / 1000} mm`] : []),
    ...(triangles > 0 ? [`at least ${count(triangles)} triangles`] : []),
    ...(close ? ['all holes closed'] : fill_holes_mm > 0 ? [`holes up to ${fill_holes_mm / 10} cm filled`] : []),
  ].join(', ');
}

// Behind the name of an export. `loaded_bytes`: how much of it has come, null when it is not being taken.
export function exportWords(one: ScanExport, loaded_bytes: number | null): string {
  const share = (done: number): string => `${Math.floor(100 * Math.min(1, done))} %`;
  if (loaded_bytes !== null) return `Loading, ${share(loaded_bytes / Math.max(1, one.size_bytes))}`;
  switch (one.state) {
    case 'ready':
      return sizeWords(one.size_bytes);
    case 'running':
      return one.done > 0 ? `Being made, ${share(one.done)}` : 'Being made';
    case 'queued':
      return one.words ? 'Waits for room on the disk' : 'Waits for its turn';
    case 'failed':
      return one.words ? `Failed: ${one.words}` : 'Failed';
    case 'missing':
      return 'Make it';
  }
}
