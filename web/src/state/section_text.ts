// What is said of a section, and how its files are called. Pure.
import { t } from '../texts/texts';
import { zeroOf, type Model, type Section } from './cutting';
import { exactNumber, metresText } from './quantities';
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
  return t.ofLinesIn(
    metresText(lengthOf(lines), 2),
    lines.length === 1 ? t.onePiece : t.piecesCount(count(lines.length)),
  );
}

// From the floor or where the model begins.
function sectionPlace_m(model: Model, section: Section): number {
  return section.at_m - zeroOf(model, section);
}

// "1.200 m"
export function placeText(model: Model, section: Section): string {
  return metresText(sectionPlace_m(model, section), 3);
}

// In the drawing, for those who find it later.
export function drawingText(model: Model, section: Section): string {
  const place = placeText(model, section);
  if (section.kind === 'horizontal') return t.horizontalSectionAt(place);
  return t.verticalSectionAtTurnedByDegrees(place, exactNumber(section.turn_deg));
}

// Behind the name of the scan, the same in every language: "section_horizontal_1.200m".
export function sectionName(model: Model, section: Section): string {
  const turn =
    section.kind === 'vertical' && section.turn_deg !== 0 ? `_${section.turn_deg}deg` : '';
  // -0 loses its sign in the next line.
  const place_m = Number(sectionPlace_m(model, section).toFixed(3));
  return `section_${section.kind}${turn}_${place_m.toFixed(3)}m`;
}
