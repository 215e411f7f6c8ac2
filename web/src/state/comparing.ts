// What a comparison says, as texts and colours.
import type { ChangedRegion, CompareReport, RegionKind, Verdict } from '../connection/comparisons';
import {
  pointStates,
  type ComparedChunk,
  type PointStateName,
} from '../connection/compared_points';
import { decimal, t } from '../texts/texts';
import { millimetresText } from './quantities';

export const looks = ['overlay', 'sides'] as const; // one over the other; side by side
export type Look = (typeof looks)[number];

type Rgb = readonly [number, number, number];

export const fullColor_m = 0.05; // from here on colours stay the same
const faintest = 0.3; // of the least change, in shares of the full colour
const [nearer, farther, pale]: readonly Rgb[] = [
  [226, 40, 28],
  [30, 92, 232],
  [240, 236, 232],
] as const;
const fixed: Readonly<Record<'removed' | 'added', Rgb>> = {
  removed: [214, 39, 196],
  added: [44, 180, 60],
};
const tint = 0.65; // side by side: of a change on a point's own colour

const kindText: Record<RegionKind, string> = {
  added: t.added,
  removed: t.removed,
  moved_towards: t.nearer,
  moved_away: t.farther,
};
export const kindOf = (region: ChangedRegion): string => kindText[region.kind];

const verdictText: Record<Verdict, string> = {
  same_place: t.bothScansShowTheSamePlace,
  different_places: t.theseScansDoNotShowThe,
  ambiguous: t.thePlaceLooksAlikeFromTwo,
  sliding: t.theScansCanSlideAlongEach,
  mirrored: t.oneOfTheScansIsMirrored,
  too_sparse: t.theScansAreTooSmallOrToo,
};

// A sentence or two for people.
export function verdictOf({ verdict, regions, comparedArea_m2 }: CompareReport): string {
  if (verdict !== 'same_place') return verdictText[verdict];
  const area = decimal(comparedArea_m2, 1);
  if (regions.length === 0) return t.nothingHasChangedOnM2(area);
  return regions.length === 1 ? t.oneChangeOnM2(area) : t.changesOnM2(regions.length, area);
}

// What is not known, and what the figures mean; each a sentence.
export function remarksOf(report: CompareReport): string[] {
  const percent = (share: number): string => decimal(100 * share, 0);
  if (report.verdict !== 'same_place')
    return [t.inTheBestPositionAgrees(percent(report.agreeingShare), percent(report.overlap))];
  const [firstKnown, secondKnown] = report.pathsKnown;
  const [firstParts, secondParts] = report.partCounts;
  return [
    ...(firstParts > 1 ? [t.theFirstScanIsInParts(firstParts)] : []),
    ...(secondParts > 1 ? [t.theSecondScanIsInParts(secondParts)] : []),
    t.changesFromOnAreShown(millimetresText(report.leastChange_m, 0)),
    ...(report.weakestSigma_m === null
      ? []
      : [t.theScansLieToEachOther(millimetresText(2 * report.weakestSigma_m, 1))]),
    ...(report.unseenArea_m2 >= 0.05
      ? [t.m2WereNotSeenByThe(decimal(report.unseenArea_m2, 1))]
      : []),
    ...(secondKnown ? [] : [t.nothingCouldBeCalledRemoved]),
    ...(firstKnown ? [] : [t.nothingCouldBeCalledAdded]),
  ];
}

// "23.4 mm ± 2.1 mm", or its area.
export function sizeOf(region: ChangedRegion): string {
  const area =
    region.area_m2 < 0.1
      ? t.cm2(decimal(1e4 * region.area_m2, 0))
      : t.m2(decimal(region.area_m2, 2));
  if (region.kind === 'added' || region.kind === 'removed') return area;
  return t.byWithinOn(
    millimetresText(Math.abs(region.distance_m), 1),
    millimetresText(1.96 * region.sigma_m, 1),
    area,
  );
}

// Of a change by so many metres, signed.
export function colorOfDistance(distance_m: number): Rgb {
  const share = faintest + (1 - faintest) * Math.min(1, Math.abs(distance_m) / fullColor_m);
  return mixed(pale!, distance_m > 0 ? nearer! : farther!, share);
}

// Null: what has not changed keeps what it has.
export function changeColor(state: PointStateName, distance_m: number): Rgb | null {
  if (state === 'removed' || state === 'added') return fixed[state];
  return state === 'moved' && Number.isFinite(distance_m) ? colorOfDistance(distance_m) : null;
}

// Red, green, blue and 255 of each point of a chunk.
export function colorsOf({ points, states, distances_m }: ComparedChunk, look: Look): Uint8Array {
  const colors = points.colors.slice();
  for (let i = 0; i < points.count; ++i) {
    const own: Rgb = [colors[4 * i]!, colors[4 * i + 1]!, colors[4 * i + 2]!];
    const state = pointStates[states[i]!] ?? 'unseen';
    const change = changeColor(state, distances_m[i]!);
    if (look === 'sides') {
      if (change) colors.set(mixed(own, change, tint), 4 * i);
      continue;
    }
    colors.set(change ?? greyOf(own, state), 4 * i);
  }
  return colors;
}

// Over the first scan, of the second one what the first does not have.
export function isShown(
  scan: 0 | 1,
  state: PointStateName,
  distance_m: number,
  look: Look,
): boolean {
  return (
    look === 'sides' ||
    scan === 0 ||
    state === 'added' ||
    (state === 'unseen' && !Number.isFinite(distance_m))
  );
}

function greyOf(own: Rgb, state: PointStateName): Rgb {
  const mean = (own[0] + own[1] + own[2]) / 3;
  const grey = Math.round(state === 'unseen' ? 30 + mean / 5 : 90 + mean / 2.2);
  return [grey, grey, grey];
}

function mixed(from: Rgb, to: Rgb, share: number): Rgb {
  const [r, g, b] = from.map((value, i) => Math.round(value + (to[i]! - value) * share));
  return [r!, g!, b!];
}

export const cssOf = ([r, g, b]: Rgb): string => `rgb(${r} ${g} ${b})`;

// The older one comes first: then what was added is what came later.
export function ordered<Scan extends { readonly id: string; readonly started: Date | null }>(
  one: Scan,
  other: Scan,
): readonly [Scan, Scan] {
  const [a, b] = [one.started?.getTime() ?? 0, other.started?.getTime() ?? 0];
  return a < b || (a === b && one.id < other.id) ? [one, other] : [other, one];
}
