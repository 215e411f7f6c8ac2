// The model on the page of its quality: images with a scale, and how large it is.
import { strayShare, type ModelLook, type ModelImage, type ViewName } from '../scene/model_images';
import { planSquare_m, scaleBar_m } from '../state/model_figures';
import type { Fact } from '../state/quality_facts';
import { percentText } from '../state/quality_text';
import { lengthText, metresText } from '../state/quantities';
import { decimal, t } from '../texts/texts';
import { element } from './dom';

const viewNames: Record<ViewName, string> = {
  above: t.fromAbove,
  ahead: t.lookingAhead,
  right: t.lookingRight,
  back: t.lookingBack,
  left: t.lookingLeft,
};

export function factList(facts: readonly Fact[]): HTMLElement {
  const rows = facts
    .filter(([, value]) => value !== null)
    .map(([label, value]) =>
      element('div', {}, element('dt', {}, label), element('dd', {}, value)),
    );
  return element('dl', { class: 'quality-facts' }, ...rows);
}

// `parts`: that the model is in, not joined.
export function modelSection(
  { extent, extentOf, hasWalls, figures, hasPath, images, confidence }: ModelLook,
  parts: number,
): HTMLElement {
  const [along_m, up_m, across_m] = extent.low_m.map((low, k) => extent.high_m[k]! - low) as [
    number,
    number,
    number,
  ];
  const [plan, ...sides] = images;
  const within = `${decimal(100 * (1 - 2 * strayShare), 0)} %`;
  return element(
    'div',
    {},
    factList([
      [
        t.extent,
        t.extentOfTheModel(metresText(along_m, 2), metresText(across_m, 2), metresText(up_m, 2)),
      ],
      [t.areaOfTheSurface, figures && areaText(figures.area_m2)],
      [t.groundPlan, figures?.plan_m2 ? areaText(figures.plan_m2) : null],
      [
        t.floorSeen,
        figures && figures.floorShare !== null
          ? t.ofTheGroundPlan(percentText(figures.floorShare))
          : null,
      ],
      [t.lowConfidence, confidence && t.ofThePoints(percentText(confidence.lowShare))],
    ]),
    note(
      parts > 1 ? t.thePartsLieToEachOther : '',
      directionText(hasWalls, hasPath),
      extentOf === 'all'
        ? t.allOfTheModelIsWithin
        : extentOf === 'surface'
          ? t.inEachDirectionOfTheSurface(within)
          : t.inEachDirectionOfThePoints(within),
      figures
        ? figures.plan_m2 === null
          ? t.theModelIsTooLargeFor
          : t.theGroundPlanIsAllSquares(lengthText(planSquare_m))
        : '',
      figures && figures.floorShare !== null ? t.theLowestLevelSurfaceOfSome : '',
      t.placesThatNobodyHasLookedAt,
    ),
    element(
      'div',
      { class: 'model-pictures' },
      figureOf(plan!, viewNames[plan!.view]),
      confidence && figureOf(confidence.image, t.confidence, true),
      ...sides.map((image) => figureOf(image, viewNames[image.view])),
    ),
    note(
      t.allPicturesHaveTheSameScale,
      hasPath
        ? hasWalls
          ? t.aheadIsWhereTheCameraLookedTurned
          : t.aheadIsWhereTheCameraLooked
        : '',
      hasPath ? t.theLineIsThePathOf : '',
      confidence ? t.confidenceGrowsWithEveryFrame : '',
    ),
  );
}

// How the extent lies.
function directionText(hasWalls: boolean, hasPath: boolean): string {
  if (hasWalls) return t.theExtentIsAlongAndAcross;
  return hasPath ? t.thereAreNoUprightSurfacesCamera : t.thereAreNoUprightSurfacesAxes;
}

function note(...sentences: readonly string[]): HTMLElement {
  return element('p', { class: 'quality-note' }, sentences.filter((part) => part !== '').join(' '));
}

function figureOf({ canvas, width_m }: ModelImage, name: string, hasColors = false): HTMLElement {
  const bar_m = scaleBar_m(width_m);
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', t.theModelNamed(name));
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  for (const [key, value] of Object.entries({
    viewBox: `0 0 100 2`,
    preserveAspectRatio: 'none',
    class: 'scale-bar',
    'aria-hidden': 'true',
  }))
    svg.setAttribute(key, value);
  const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
  const end = ((100 * bar_m) / width_m).toFixed(3);
  path.setAttribute('d', `M0 0V2M0 1H${end}M${end} 0V2`);
  svg.append(path);
  return element(
    'figure',
    { class: 'model-picture' },
    canvas,
    svg,
    element(
      'figcaption',
      {},
      element('span', {}, lengthText(bar_m)),
      element('span', {}, name),
      hasColors ? element('span', { class: 'confidence-colors', 'aria-hidden': 'true' }) : null,
    ),
  );
}

function areaText(area_m2: number): string {
  return t.m2(decimal(area_m2, area_m2 < 10 ? 2 : 1));
}
