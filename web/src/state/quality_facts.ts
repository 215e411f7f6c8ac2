// What the page of a scan's quality lists in numbers. Null: it is not known, and the row is left out. Pure functions.
import type { ScanSummary } from '../connection/api';
import type { Report } from '../connection/scans';
import type { CameraPath } from './camera_path';
import { durationText, percentText, type Followed } from './quality_text';
import { count, framesText, phaseText, withinText } from './text';

export type Fact = readonly [label: string, value: string | null];

export function scanFacts({ phase, started, ended, imported, ...scan }: ScanSummary, path: CameraPath | null): Fact[] {
  return [
    [imported ? 'Imported' : 'Begun', started && dateText(started)],
    [
      'State',
      imported
        ? null
        : `${phaseText(phase).text}${ended && started ? `, ${durationText((ended.getTime() - started.getTime()) / 1000)} after it began` : ''}`,
    ],
    ['Frames', imported || phase === 'running' ? null : framesText(scan)], // of a running one the sentence has newer numbers
    ['Recorded', path && `${durationText(path.duration_s)} by the camera’s clock`],
    [
      'Path of the camera',
      !path || path.length_m === 0 ? null : `${path.length_m.toFixed(path.length_m < 10 ? 2 : 1)} m while it was followed`,
    ],
  ];
}

export interface FrameShare {
  readonly kind: 'tracked' | 'weak' | 'lost' | 'unused';
  readonly label: string;
  readonly value: string;
}

// Of the frames that were processed (older reports do not say which were doubtful), and beside them those that were not used. Empty when nobody knows.
export function frameShares({ frames, tracked, weak, counts }: Followed): FrameShare[] {
  if (!frames || tracked === null) return [];
  const unused = counts ? counts.left_out + counts.refused + counts.damaged : 0;
  const shareText = (number: number): string => `${percentText(number / frames)}, ${count(number)} ${number === 1 ? 'frame' : 'frames'}`;
  return [
    ...(weak === null
      ? [{ kind: 'tracked', label: 'Followed, doubtful ones included', value: shareText(tracked) } as const]
      : [
          { kind: 'tracked', label: 'Followed', value: shareText(tracked - weak) } as const,
          { kind: 'weak', label: 'Doubtful', value: shareText(weak) } as const,
        ]),
    { kind: 'lost', label: 'Lost', value: shareText(frames - tracked) },
    ...(unused > 0
      ? [{ kind: 'unused', label: 'Not used', value: `${count(unused)} ${unused === 1 ? 'frame' : 'frames'} beside these` } as const]
      : []),
  ];
}

// Of the camera's pose at the end; older reports and those of scans without a tracked frame do not.
export function statesUncertainty({ positionSigma_m, trackedFrames }: Report): boolean {
  return positionSigma_m !== null && positionSigma_m > 0 && trackedFrames !== 0;
}

export function mapFacts(report: Report): Fact[] {
  const { mapping, positionSigma_m, rotationSigma_deg, meanFrame_ms, device } = report;
  const number = (...names: string[]): string | null => {
    const known = names.filter((name) => name in mapping);
    return known.length === 0 ? null : count(known.reduce((sum, name) => sum + mapping[name]!, 0));
  };
  const isStated = statesUncertainty(report);
  return [
    ['Loops closed', number('loops by appearance', 'loops by nearness')],
    ['Loops rejected', number('impossible places', 'ambiguous places', 'impossible loops', 'unrepeated loops', 'contradicting loops')],
    ['Corrections of the whole map', number('global adjustments')],
    ['Lost and found again', number('found again')],
    ['Submaps', number('submaps')],
    ['Keyframes', number('keyframes')],
    ['Parts', number('parts')],
    ['Parts joined', number('joined parts')],
    ['Position at the end', isStated ? withinText(positionSigma_m!) : null],
    ['Direction at the end', isStated && rotationSigma_deg !== null ? `± ${(2 * rotationSigma_deg).toFixed(1)}°` : null],
    ['Time for a frame', meanFrame_ms === null ? null : `${meanFrame_ms.toFixed(0)} ms on average`],
    ['Computed on', device || null],
  ];
}

export function dateText(date: Date): string {
  return date.toLocaleString('en-GB', { day: 'numeric', month: 'long', year: 'numeric', hour: '2-digit', minute: '2-digit' });
}
