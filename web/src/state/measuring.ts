// The tape measure of one page: what it measures, which points were chosen, what came of
// them, what is kept. Pure.
import type { KeptMeasurement, Measured, MeasureKind, Place } from '../connection/measurements';
import { t } from '../texts/texts';

export interface Measuring {
  readonly active: boolean; // clicks choose points
  readonly measure: MeasureKind;
  // Those that were chosen, while some are missing or the server is asked.
  readonly points: readonly Place[];
  readonly busy: boolean; // the server is asked
  readonly newest: Measured | null; // that is not kept
  readonly kept: readonly KeptMeasurement[];
  readonly problem: string; // for people, or empty
}

export const initialMeasuring: Measuring = {
  active: false,
  measure: 'distance',
  points: [],
  busy: false,
  newest: null,
  kept: [],
  problem: '',
};

export type MeasuringEvent =
  | { readonly kind: 'active'; readonly active: boolean }
  | { readonly kind: 'wanted'; readonly measure: MeasureKind }
  | { readonly kind: 'chosen'; readonly place: Place | null } // null: nothing was there
  | { readonly kind: 'undone' } // the last point
  | { readonly kind: 'closed' } // the outline of an area
  | { readonly kind: 'measured'; readonly measured: Measured }
  | { readonly kind: 'listed'; readonly kept: readonly KeptMeasurement[] }
  | { readonly kind: 'kept'; readonly one: KeptMeasurement }
  | { readonly kind: 'removed'; readonly id: string }
  | { readonly kind: 'failed'; readonly message: string };

export const leastCorners = 3;
const mostCorners = 64; // the server takes no more

// By the name of it, in front of people.
export const measureLabels: Record<MeasureKind, string> = {
  distance: t.distance,
  plane: t.toAPlane,
  height: t.height,
  angle: t.angle,
  area: t.area,
};

const invitations: Record<MeasureKind, string> = {
  distance: t.clickOnTwoPoints,
  plane: t.clickOnAPointThenOn,
  height: t.clickOnTwoPointsHowMuch,
  angle: t.clickOnTwoSurfacesThatAre,
  area: t.clickOnTheCornersOneAfter,
};
const seconds: Record<MeasureKind, string> = {
  distance: t.clickOnTheSecondPoint,
  plane: t.nowClickOnThePlane,
  height: t.clickOnTheSecondPoint,
  angle: t.clickOnTheSecondSurface,
  area: t.clickOnTheNextCorner,
};

export function reduceMeasuring(state: Measuring, event: MeasuringEvent): Measuring {
  switch (event.kind) {
    case 'active':
      return { ...state, active: event.active, points: [], busy: false, newest: null, problem: '' };
    case 'wanted':
      return {
        ...state,
        measure: event.measure,
        points: [],
        busy: false,
        newest: null,
        problem: '',
      };
    case 'chosen':
      return chosen(state, event.place);
    case 'undone':
      return state.busy ? state : { ...state, points: state.points.slice(0, -1), problem: '' };
    case 'closed':
      if (state.busy || state.measure !== 'area' || state.points.length === 0) return state;
      return state.points.length < leastCorners
        ? { ...state, problem: t.anAreaHasThreeCornersOr }
        : { ...state, busy: true, problem: '' };
    case 'measured':
      return state.busy ? { ...state, points: [], busy: false, newest: event.measured } : state;
    case 'listed':
      return { ...state, kept: event.kept };
    case 'kept':
      return { ...state, kept: [...state.kept, event.one], newest: null, problem: '' };
    case 'removed':
      return { ...state, kept: state.kept.filter((one) => one.id !== event.id), problem: '' };
    case 'failed':
      // The corners of an area stay, so that the wrong one can be taken back.
      return {
        ...state,
        points: state.measure === 'area' ? state.points : [],
        busy: false,
        problem: messageForPeople(event.message, state.measure),
      };
  }
}

function chosen(state: Measuring, place: Place | null): Measuring {
  if (state.busy) return state;
  if (!place) return { ...state, problem: t.thereIsNothingClickOnA };
  const points = [...state.points, place];
  return {
    ...state,
    points,
    newest: null,
    problem: '',
    busy: points.length === (state.measure === 'area' ? mostCorners : 2),
  };
}

export function canClose({ measure, points, busy }: Measuring): boolean {
  return measure === 'area' && points.length >= leastCorners && !busy;
}

// What the page asks for now.
export function measuringText(state: Measuring): string {
  if (state.problem !== '') return state.problem;
  if (state.busy) return t.measuring;
  if (canClose(state)) return t.cornersToCloseTheOutlineClick(state.points.length);
  if (state.points.length > 0) return seconds[state.measure];
  return state.newest ? t.clickForTheNextOne : invitations[state.measure];
}

// Whether the newest of those that are kept has just come.
export function hasNewest(
  before: readonly KeptMeasurement[],
  now: readonly KeptMeasurement[],
): boolean {
  const newest = now.at(-1);
  return newest !== undefined && !before.some((one) => one.id === newest.id);
}

// A name that no kept one has yet.
export function freeName(kept: readonly KeptMeasurement[], measure: MeasureKind): string {
  const names = new Set(kept.map((one) => one.name));
  const label = measure === 'plane' ? t.distanceToAPlane : measureLabels[measure];
  let number = kept.filter((one) => one.kind === measure).length + 1;
  while (names.has(`${label} ${number}`)) ++number;
  return `${label} ${number}`;
}

// The server names the fields of the request.
function messageForPeople(message: string, measure: MeasureKind): string {
  return message.replace(/^The server says: points\[(\d+)\]:? /, (_, index) => {
    const number = Number(index) + 1;
    return measure === 'area' ? t.corner(number) : number === 1 ? t.firstPoint : t.secondPoint;
  });
}
