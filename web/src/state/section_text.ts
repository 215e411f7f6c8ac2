// What is said of a section, and how its files are called. Pure.
import { t } from '../texts/texts';
import { zeroOf, type Model, type Section } from './cutting';
import { lengthOf, type Polyline } from './section';
import { count } from './text';

export interface CutSurface {
  readonly surface: 'none' | 'growing' | 'finished';
  readonly lines: readonly Polyline[];
}

export const noCut = t.thePlaneDoesNotCutThe;

export function sectionText({ surface, lines }: CutSurface): string {
  if (surface === 'none') return t.thereIsNoSurfaceThatCould;
  if (lines.length === 0) return noCut;
  if (surface === 'growing') return t.theSectionCanBeDownloadedWhen;
  return t.ofLinesIn(metres(lengthOf(lines)), lines.length === 1 ? t.onePiece : t.piecesCount(count(lines.length)));
}

// "1.200 m", from the floor or where the model begins.
export function placeText(model: Model, section: Section): string {
  return metres(section.at_m - zeroOf(model, section), 3);
}

// In the drawing, for those who find it later.
export function drawingText(model: Model, section: Section): string {
  const place = placeText(model, section);
  if (section.kind === 'horizontal') return t.horizontalSectionAt(place);
  return t.verticalSectionAtTurnedByDegrees(place, section.turn_deg);
}

// Behind the name of the scan: "section_horizontal_1.200m".
export function sectionName(model: Model, section: Section): string {
  const turn = section.kind === 'vertical' && section.turn_deg !== 0 ? `_${section.turn_deg}deg` : '';
  return `section_${section.kind}${turn}_${placeText(model, section).replace(' ', '').replace('−', '-')}`;
}

function metres(value_m: number, digits = 2): string {
  const text = Math.abs(value_m).toFixed(digits);
  return `${value_m < 0 && Number(text) !== 0 ? '−' : ''}${text} m`;
}
