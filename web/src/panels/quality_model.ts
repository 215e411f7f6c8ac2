// The model on the page of its quality: images with a scale, and how large it is.
import { strayShare, type ModelLook, type ModelImage } from '../scene/model_images';
import { planSquare_m, scaleBar_m } from '../state/model_figures';
import type { Fact } from '../state/quality_facts';
import { percentText } from '../state/quality_text';
import { element } from './dom';

export function factList(facts: readonly Fact[]): HTMLElement {
  const rows = facts
    .filter(([, value]) => value !== null)
    .map(([label, value]) => element('div', {}, element('dt', {}, label), element('dd', {}, value)));
  return element('dl', { class: 'quality-facts' }, ...rows);
}

// `parts`: that the model is in, not joined.
export function modelSection({ extent, extentOf, hasWalls, figures, hasPath, images, confidence }: ModelLook, parts: number): HTMLElement {
  const [along_m, up_m, across_m] = extent.low_m.map((low, k) => extent.high_m[k]! - low) as [number, number, number];
  const [plan, ...sides] = images;
  const within = percentText(1 - 2 * strayShare).replace('.0', '');
  return element(
    'div',
    {},
    factList([
      ['Extent', `${along_m.toFixed(2)} m × ${across_m.toFixed(2)} m, ${up_m.toFixed(2)} m high`],
      ['Area of the surface', figures && areaText(figures.area_m2)],
      ['Ground plan', figures?.plan_m2 ? areaText(figures.plan_m2) : null],
      ['Floor seen', figures && figures.floorShare !== null ? `${percentText(figures.floorShare)} of the ground plan` : null],
      ['Low confidence', confidence && `${percentText(confidence.lowShare)} of the points`],
    ]),
    note(
      parts > 1 ? 'The parts lie to each other as nobody knows: extent, ground plan and pictures are right only within each.' : '',
      directionText(hasWalls, hasPath),
      extentOf === 'all'
        ? 'All of the model is within it.'
        : `In each direction ${within} of the ${extentOf} ${extentOf === 'surface' ? 'is' : 'are'} between its ends, so that stray points do not count.`,
      figures
        ? figures.plan_m2 === null
          ? 'The model is too large for a ground plan.'
          : `The ground plan is all squares of ${100 * planSquare_m} cm with any surface in them, seen from above.`
        : '',
      figures && figures.floorShare !== null ? 'The lowest level surface of some size counts as the floor.' : '',
      'Places that nobody has looked at are in no figure: how much is missing cannot be told from the scan.',
    ),
    element(
      'div',
      { class: 'model-pictures' },
      figureOf(plan!),
      confidence && figureOf(confidence.image, true),
      ...sides.map((image) => figureOf(image)),
    ),
    note(
      'All pictures have the same scale and no perspective. What is seen from behind is left out, so that one looks into a room.',
      hasPath
        ? `Ahead is where the camera looked in the first frame${hasWalls ? ', turned by up to 45° to the nearest direction of the upright surfaces' : ''}.`
        : '',
      hasPath ? 'The line is the path of the camera, from the dot on.' : '',
      confidence
        ? 'Confidence grows with every frame that sees a place, most from near and straight ahead: from violet, 3 or less, to yellow, 20 and more. Low is below 6; a point needs 3 to be kept.'
        : '',
    ),
  );
}

// How the extent lies.
function directionText(hasWalls: boolean, hasPath: boolean): string {
  if (hasWalls) return 'The extent is along and across the direction that most upright surfaces face.';
  const instead = hasPath
    ? 'it is along and across where the camera looked in the first frame'
    : 'it is along and across the axes that the model came with';
  return `There are no upright surfaces to turn the extent to: ${instead}.`;
}

function note(...sentences: readonly string[]): HTMLElement {
  return element('p', { class: 'quality-note' }, sentences.filter((part) => part !== '').join(' '));
}

function figureOf({ name, canvas, width_m }: ModelImage, hasColors = false): HTMLElement {
  const bar_m = scaleBar_m(width_m);
  const label = bar_m < 1 ? `${Math.round(100 * bar_m)} cm` : `${bar_m} m`;
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', `The model: ${name}`);
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
      element('span', {}, label),
      element('span', {}, name),
      hasColors ? element('span', { class: 'confidence-colors', 'aria-hidden': 'true' }) : null,
    ),
  );
}

function areaText(area_m2: number): string {
  return `${area_m2 < 10 ? area_m2.toFixed(2) : area_m2.toFixed(1)} m²`;
}
