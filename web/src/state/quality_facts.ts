// What the page of a scan's quality lists in numbers. Null: it is not known, and the row is
// left out. Pure functions.
import type { ScanSummary } from '../connection/api';
import type { Report } from '../connection/scans';
import type { CameraPath } from './camera_path';
import { decimal, locale, t } from '../texts/texts';
import { percentText, type Followed } from './quality_text';
import {
  durationText,
  metresText,
  millisecondsText,
  roundedUpText,
  withinText,
} from './quantities';
import { count, framesNumber, framesText, phaseText } from './text';

export type Fact = readonly [label: string, value: string | null];

export function scanFacts(
  { phase, started, ended, imported, ...scan }: ScanSummary,
  path: CameraPath | null,
): Fact[] {
  return [
    [imported ? t.imported : t.begun, started && dateText(started)],
    [t.state, imported ? null : stateText(phaseText(phase).text, started, ended)],
    // Of a running scan the sentence above has newer numbers.
    [t.frames, imported || phase === 'running' ? null : framesText(scan)],
    [t.recorded, path && t.byTheCamerasClock(durationText(path.duration_s))],
    [
      t.pathOfTheCamera,
      !path || path.length_m === 0
        ? null
        : t.whileItWasFollowed(metresText(path.length_m, path.length_m < 10 ? 2 : 1)),
    ],
  ];
}

function stateText(state: string, started: Date | null, ended: Date | null): string {
  return ended && started
    ? t.afterItBegan(state, durationText((ended.getTime() - started.getTime()) / 1000))
    : state;
}

export interface FrameShare {
  readonly kind: 'tracked' | 'weak' | 'lost' | 'unused';
  readonly label: string;
  readonly value: string;
}

// Of the frames that were processed (older reports do not say which were doubtful), and beside them
// those that were not used. Empty when nobody knows.
export function frameShares({ frames, tracked, weak, counts }: Followed): FrameShare[] {
  if (!frames || tracked === null) return [];
  const unused = counts ? counts.left_out + counts.refused + counts.damaged : 0;
  const shareText = (number: number): string =>
    `${percentText(number / frames)}, ${framesNumber(number)}`;
  return [
    ...(weak === null
      ? [
          {
            kind: 'tracked',
            label: t.followedDoubtfulOnesIncluded,
            value: shareText(tracked),
          } as const,
        ]
      : [
          { kind: 'tracked', label: t.followed, value: shareText(tracked - weak) } as const,
          { kind: 'weak', label: t.doubtful, value: shareText(weak) } as const,
        ]),
    { kind: 'lost', label: t.lost, value: shareText(frames - tracked) },
    ...(unused > 0
      ? [{ kind: 'unused', label: t.notUsed, value: t.besideThese(framesNumber(unused)) } as const]
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
    [t.loopsClosed, number('loops by appearance', 'loops by nearness')],
    [
      t.loopsRejected,
      number(
        'impossible places',
        'ambiguous places',
        'impossible loops',
        'unrepeated loops',
        'contradicting loops',
      ),
    ],
    [t.correctionsOfTheWholeMap, number('global adjustments')],
    [t.lostAndFoundAgain, number('found again')],
    [t.submaps, number('submaps')],
    [t.keyframes, number('keyframes')],
    [t.parts, number('parts')],
    [t.partsJoined, number('joined parts')],
    [
      t.expectedErrorOfThePath,
      report.expectedPathError_m === null ? null : roundedUpText(report.expectedPathError_m),
    ],
    [t.positionAtTheEnd, isStated ? withinText(positionSigma_m!) : null],
    [
      t.directionAtTheEnd,
      isStated && rotationSigma_deg !== null ? `± ${decimal(2 * rotationSigma_deg, 1)}°` : null,
    ],
    [t.timeForAFrame, meanFrame_ms === null ? null : t.onAverage(millisecondsText(meanFrame_ms))],
    [t.computedOn, device || null],
  ];
}

export function dateText(date: Date): string {
  return date.toLocaleString(locale, {
    day: 'numeric',
    month: 'long',
    year: 'numeric',
    hour: '2-digit',
    minute: '2-digit',
  });
}
