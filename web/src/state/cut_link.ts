// Clip box and section plane as query parameters, so that a link opens the
// same view. Pure functions.
import { dot, type Axes, type Triple } from './axes';
import { initialCutting, sectionKinds, type Box, type Cutting, type Section } from './cutting';

const farthest_m = 1e7;

// Returns 'axes=…&clip=…&cut=…', or an empty text if there is neither a clip box nor a section.
export function cutQuery({ axes, clip, section }: Cutting): string {
  if (!axes || (!clip && !section)) return '';
  const text = (values: readonly number[], digits: number): string =>
    values.map((value) => String(Number(value.toFixed(digits)))).join(',');
  return [
    `axes=${text([...axes.along, ...axes.up], 6)}`,
    ...(clip ? [`clip=${text([...clip.low_m, ...clip.high_m], 4)}`] : []),
    ...(section ? [`cut=${section.kind},${text([section.at_m, section.turn_deg], 4)}`] : []),
  ].join('&');
}

// Ignores parameters that are missing or malformed.
export function readCut(query: string): Cutting {
  const fields = new URLSearchParams(query);
  const axes = axesOf(numbers(fields.get('axes'), 6));
  if (!axes) return initialCutting;
  return {
    ...initialCutting,
    axes,
    clip: boxOf(numbers(fields.get('clip'), 6)),
    section: sectionOf(fields.get('cut')),
  };
}

function numbers(text: string | null, count: number): number[] | null {
  const values = (text ?? '').split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));
  return values.length === count && values.every((value) => Math.abs(value) <= farthest_m)
    ? values
    : null;
}

function axesOf(values: number[] | null): Axes | null {
  if (!values) return null;
  const [along, up] = [values.slice(0, 3), values.slice(3)] as unknown as [Triple, Triple];
  const isUnit = (one: Triple): boolean => Math.abs(Math.hypot(...one) - 1) < 1e-3;
  return isUnit(along) && isUnit(up) && Math.abs(dot(along, up)) < 1e-3 ? { along, up } : null;
}

function boxOf(values: number[] | null): Box | null {
  if (!values || [0, 1, 2].some((k) => values[k]! > values[k + 3]!)) return null;
  return {
    low_m: values.slice(0, 3) as unknown as Triple,
    high_m: values.slice(3) as unknown as Triple,
  };
}

function sectionOf(text: string | null): Section | null {
  const [name, ...rest] = (text ?? '').split(',');
  const kind = sectionKinds.find((one) => one === name);
  const values = numbers(rest.join(','), 2);
  return kind && values && Math.abs(values[1]!) <= 90
    ? { kind, at_m: values[0]!, turn_deg: values[1]! }
    : null;
}
