// What of a model is looked at: a clip box and a section plane, along the axes of the model. Pure.
import { combined, cross, dot, threeOf, type Axes, type Triple } from './axes';

// Along the axes: along, up, across; in metres from the world's origin.
export interface Box {
  readonly low_m: Triple;
  readonly high_m: Triple;
}

export interface Model extends Box {
  readonly axes: Axes;
  readonly floor_m: number; // along up; where no floor is known, the lowest part
}

export const sectionKinds = ['horizontal', 'vertical'] as const;
export type SectionKind = (typeof sectionKinds)[number];

export interface Section {
  readonly kind: SectionKind;
  readonly at_m: number; // along its normal from the world's origin
  readonly turn_deg: number; // about up; of a vertical one
}

// In the world of the scan. (u, v, normal) is right-handed: whoever looks against the normal sees u
// to the right and v upwards.
export interface Plane {
  readonly u: Triple;
  readonly v: Triple;
  readonly normal: Triple;
  readonly at_m: number;
}

export interface Cutting {
  readonly active: boolean; // the tool is open
  readonly axes: Axes | null; // of clip and section
  readonly model: Model | null; // as it was measured last
  readonly clip: Box | null;
  readonly section: Section | null;
}

export interface Face {
  readonly axis: 0 | 1 | 2;
  readonly side: 'low_m' | 'high_m';
}

export const faces: readonly Face[] = ([0, 1, 2] as const).flatMap((axis) => [
  { axis, side: 'low_m' } as const,
  { axis, side: 'high_m' } as const,
]);

export type CuttingEvent =
  | { readonly kind: 'active'; readonly active: boolean }
  | { readonly kind: 'measured'; readonly model: Model }
  | { readonly kind: 'clip'; readonly on: boolean }
  | { readonly kind: 'reset'; readonly model: Model } // the clip box, to all of the model
  | { readonly kind: 'face'; readonly face: Face; readonly to_m: number }
  | { readonly kind: 'cut'; readonly by: SectionKind | 'off' }
  | { readonly kind: 'moved'; readonly at_m: number }
  | { readonly kind: 'turned'; readonly turn_deg: number };

export const initialCutting: Cutting = {
  active: false,
  axes: null,
  model: null,
  clip: null,
  section: null,
};

export const turnRange_deg = { min: -90, max: 90, step: 1 } as const;
const thinnest_m = 0.01;
const planAbove_m = 1.2; // the floor: where plans of rooms are cut

export function reduceCutting(state: Cutting, event: CuttingEvent): Cutting {
  switch (event.kind) {
    case 'active':
      return { ...state, active: event.active };
    case 'measured':
      return measured(state, event.model);
    case 'clip':
      return { ...state, clip: event.on && state.model ? boxOf(state.model) : null };
    case 'reset':
      return { ...state, model: event.model, axes: event.model.axes, clip: boxOf(event.model) };
    case 'face':
      return state.clip && state.model
        ? { ...state, clip: moved(state.clip, event.face, event.to_m, state.model) }
        : state;
    case 'cut':
      if (event.by === 'off' || !state.model) return { ...state, section: null };
      return { ...state, section: firstSection(state.model, event.by) };
    case 'moved':
      return state.section ? { ...state, section: { ...state.section, at_m: event.at_m } } : state;
    case 'turned':
      return state.section && state.model
        ? { ...state, section: turned(state.model, state.section, event.turn_deg) }
        : state;
  }
}

// A box that held all of the model still does when the model has grown.
function measured(state: Cutting, model: Model): Cutting {
  const wasWhole = state.clip && state.model && isSame(state.clip, state.model);
  return { ...state, model, axes: model.axes, clip: wasWhole ? boxOf(model) : state.clip };
}

function boxOf({ low_m, high_m }: Box): Box {
  return { low_m, high_m };
}

function isSame(a: Box, b: Box): boolean {
  return [0, 1, 2].every((k) => a.low_m[k] === b.low_m[k] && a.high_m[k] === b.high_m[k]);
}

// Within the model, and never through the face across from it.
function moved(box: Box, { axis, side }: Face, to_m: number, model: Box): Box {
  const [low, high] = [model.low_m[axis], model.high_m[axis]];
  const [least, most] =
    side === 'low_m'
      ? [low, Math.max(low, box.high_m[axis] - thinnest_m)]
      : [Math.min(high, box.low_m[axis] + thinnest_m), high];
  const values: [number, number, number] = [...box[side]];
  values[axis] = Math.min(most, Math.max(least, to_m));
  return { ...box, [side]: values };
}

// Where the plane may stand to meet the model: along its normal.
export function rangeOf(model: Model, section: Section): readonly [number, number] {
  const { normal } = planeOf(model.axes, section);
  const reach = threeOf(model.axes).map((axis, k) => [
    dot(axis, normal) * model.low_m[k]!,
    dot(axis, normal) * model.high_m[k]!,
  ]);
  return [
    reach.reduce((sum, ends) => sum + Math.min(...ends), 0),
    reach.reduce((sum, ends) => sum + Math.max(...ends), 0),
  ];
}

// Where people count from: the floor, or where the model begins.
export function zeroOf(model: Model, section: Section): number {
  return section.kind === 'horizontal' ? model.floor_m : rangeOf(model, section)[0];
}

export function planeOf(axes: Axes, { kind, at_m, turn_deg }: Section): Plane {
  const [along, up, across] = threeOf(axes);
  if (kind === 'horizontal') return { u: along, v: cross(up, along), normal: up, at_m };
  const turn_rad = (turn_deg * Math.PI) / 180;
  const normal = combined(along, Math.cos(turn_rad), across, Math.sin(turn_rad));
  return { u: cross(up, normal), v: up, normal, at_m };
}

function firstSection(model: Model, kind: SectionKind): Section {
  const section = { kind, at_m: 0, turn_deg: 0 };
  const [low_m, high_m] = rangeOf(model, section);
  const plan_m = model.floor_m + planAbove_m;
  const isPlan = kind === 'horizontal' && plan_m > low_m && plan_m < high_m;
  return { ...section, at_m: isPlan ? plan_m : (low_m + high_m) / 2 };
}

// About the middle of the model, which it stays as far from.
function turned(model: Model, section: Section, turn_deg: number): Section {
  const middle = (of: Section): number => {
    const [low_m, high_m] = rangeOf(model, of);
    return (low_m + high_m) / 2;
  };
  const next = { ...section, turn_deg };
  return { ...next, at_m: middle(next) + section.at_m - middle(section) };
}
