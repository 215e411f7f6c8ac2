// How the scan is shown: surface or points, colour, point size, what is seen through, who leads the eye.
import type { LiveScan } from '../state/live_scan';
import type { Store } from '../state/store';
import {
  asksForSurface,
  colorModes,
  meshColors,
  pointSizeRange_percent,
  shownMeshColor,
  shows,
  type ColorMode,
  type MeshColor,
  type Show,
  type ViewOptions,
} from '../state/view_options';
import { t } from '../texts/texts';
import { element, setText, type Panel } from './dom';
import { segments } from './segments';

const showLabels: Record<Show, string> = { surface: t.surface, points: t.points };
const colorLabels: Record<ColorMode, string> = { shaded: t.shaded, rgb: t.colour, normal: t.normals, confidence: t.confidence };
const meshColorLabels: Record<MeshColor, string> = { shaded: t.shaded, rgb: t.colour, normal: t.normals };

// `more`: buttons of others.
export function viewPanel(
  options: Store<ViewOptions, Partial<ViewOptions>>,
  scan: Store<LiveScan, never>,
  frameAll: () => void,
  ...more: HTMLElement[]
): Panel {
  const show = segments('show', t.whatIsShown, shows, showLabels, (chosen) => options.dispatch({ show: chosen }));
  const colors = segments('color', t.colourOfThePoints, colorModes, colorLabels, (color) => options.dispatch({ color }));
  const surface = segments('mesh-color', t.colourOfTheSurface, meshColors, meshColorLabels, (meshColor) => options.dispatch({ meshColor }));
  const size = element('input', { type: 'range', id: 'point-size', ...pointSizeRange_percent });
  const sizeText = element('output', { for: 'point-size' });
  const slider = element('label', { class: 'slider', for: 'point-size' }, t.size, size, sizeText);
  size.addEventListener('input', () => options.dispatch({ pointSize_percent: size.valueAsNumber }));
  const inside = toggle(t.seeInside, t.makesWhatIsSeenFromBehind, () => options.dispatch({ hideBacks: !options.get().hideBacks }));
  const eyeDome = toggle(t.edges, t.eyeDomeLightingPointsAreDarker, () => options.dispatch({ eyeDome: !options.get().eyeDome }));
  const follow = toggle(t.followCamera, t.ridesBehindTheScanningCamera, () => options.dispatch({ follow: !options.get().follow }));
  const coverage = toggle(t.coverage, t.whatWasScannedWellAndWhat, () => options.dispatch({ coverage: !options.get().coverage }));
  coverage.classList.add('coverage-button');
  const frame = element('button', { type: 'button', class: 'button', title: t.showsTheWholeScanF }, t.showAll);
  frame.addEventListener('click', frameAll);
  // On a phone, while a scan runs and the model needs the room.
  const unfold = element('button', { type: 'button', class: 'button unfold', 'aria-expanded': 'false' }, t.view);
  unfold.addEventListener('click', () => unfold.setAttribute('aria-expanded', String(node.classList.toggle('unfolded'))));

  const node = element(
    'section',
    { class: 'card view', 'aria-label': t.view },
    show.element,
    unfold,
    surface.element,
    colors.element,
    slider,
    eyeDome,
    coverage,
    element('div', { class: 'buttons' }, inside, follow, frame),
    ...more,
  );
  let isTextured: boolean | null = null; // of the surface that is shown, also while another one is made
  const refresh = (): void => {
    const state = options.get();
    const { mesh, phase, triangles, surfaceHasConfidences, framesReceived } = scan.get();
    if (mesh.state === 'shown') isTextured = mesh.textured;
    const there = isTextured !== null;
    const onSurface = (there || triangles > 0) && asksForSurface(state, !there && surfaceHasConfidences === true);
    const isOnPointsOnly = state.coverage && (there || surfaceHasConfidences === false);
    show.element.hidden = isOnPointsOnly || (!there && triangles === 0 && phase !== 'running');
    show.check(state.show);
    surface.element.hidden = !onSurface || state.coverage;
    surface.check(shownMeshColor(state, isTextured ?? false));
    slider.hidden = onSurface;
    colors.element.hidden = onSurface || state.coverage;
    coverage.hidden = framesReceived === 0;
    coverage.classList.toggle('in-menu', phase !== 'running' && !state.coverage); // on a phone
    coverage.setAttribute('aria-pressed', String(state.coverage));
    colors.check(state.color);
    size.value = String(state.pointSize_percent);
    setText(sizeText, `${state.pointSize_percent} %`);
    node.classList.toggle('running', phase === 'running');
    inside.setAttribute('aria-pressed', String(state.hideBacks));
    eyeDome.setAttribute('aria-pressed', String(state.eyeDome));
    eyeDome.hidden = onSurface;
    follow.setAttribute('aria-pressed', String(state.follow));
    follow.hidden = phase === 'finished' || phase === 'interrupted' || phase === 'failed'; // nobody leads any more
  };
  const unsubscribers = [options.subscribe(refresh), scan.subscribe(refresh)];
  return {
    element: node,
    dispose() {
      for (const unsubscribe of unsubscribers) unsubscribe();
    },
  };
}

function toggle(text: string, title: string, flip: () => void): HTMLButtonElement {
  const button = element('button', { type: 'button', class: 'button', title, 'aria-pressed': 'false' }, text);
  button.addEventListener('click', flip);
  return button;
}
