// What is said of a section, and how its files are called. Pure.
import { zeroOf, type Model, type Section } from './cutting';
import { lengthOf, type Polyline } from './section';
import { count } from './words';

export interface CutSurface {
  readonly surface: 'none' | 'growing' | 'finished';
  readonly lines: readonly Polyline[];
}

export const noCut = 'The plane does not cut the surface.';

export function sectionWords({ surface, lines }: CutSurface): string {
  if (surface === 'none') return 'There is no surface that could be cut.';
  if (lines.length === 0) return noCut;
  if (surface === 'growing') return 'The section can be downloaded when the surface is finished.';
  return `${metres(lengthOf(lines))} of lines in ${lines.length === 1 ? 'one piece' : `${count(lines.length)} pieces`}.`;
}

// "1.200 m", from the floor or where the model begins.
export function placeWords(model: Model, section: Section): string {
  return metres(section.at_m - zeroOf(model, section), 3);
}

// In the drawing, for those who find it later.
export function drawingWords(model: Model, section: Section): string {
  const place = placeWords(model, section);
  if (section.kind === 'horizontal') return `horizontal section at ${place}`;
  return `vertical section at ${place}, turned by ${section.turn_deg} degrees`;
}

// Behind the name of the scan: "section_horizontal_1.200m".
export function sectionName(model: Model, section: Section): string {
  const turn = section.kind === 'vertical' && section.turn_deg !== 0 ? `_${section.turn_deg}deg` : '';
  return `section_${section.kind}${turn}_${placeWords(model, section).replace(' ', '').replace('−', '-')}`;
}

function metres(value_m: number, digits = 2): string {
  const text = Math.abs(value_m).toFixed(digits);
  return `${value_m < 0 && Number(text) !== 0 ? '−' : ''}${text} m`;
}
