// How the scan is shown: surface or points, colour, point size, what is seen
// through, who leads the eye.
import type { LiveScan } from '../state/live_scan';
import type { Store } from '../state/store';
import { viewOffer } from '../state/view_offer';
import {
  colorModes,
  meshColors,
  pointSizeRange_percent,
  shows,
  type ColorMode,
  type MeshColor,
  type Show,
  type ViewOptions,
} from '../state/view_options';
import { t } from '../texts/texts';
import { buttonOf, element, setText, type Panel } from './dom';
import { segments } from './segments';

const showLabels: Record<Show, string> = { surface: t.surface, points: t.points };
const colorLabels: Record<ColorMode, string> = {
  shaded: t.shaded,
  rgb: t.colour,
  normal: t.normals,
  confidence: t.confidence,
};
const meshColorLabels: Record<MeshColor, string> = {
  shaded: t.shaded,
  rgb: t.colour,
  normal: t.normals,
};

type OptionsStore = Store<ViewOptions, Partial<ViewOptions>>;

// `more`: buttons of others.
export function viewPanel(
  options: OptionsStore,
  scan: Store<LiveScan, never>,
  frameAll: () => void,
  ...more: HTMLElement[]
): Panel {
  const { node, show, surface, colors, size, eyeDome, coverage, inside, follow } = controlsOf(
    options,
    frameAll,
    more,
  );
  // Of the surface that is shown, also while another one is made.
  let isTextured: boolean | null = null;
  const refresh = (): void => {
    const state = options.get();
    const { mesh } = scan.get();
    if (mesh.state === 'shown') isTextured = mesh.textured;
    const offer = viewOffer(state, scan.get(), isTextured);
    show.element.hidden = !offer.show;
    show.check(state.show);
    surface.element.hidden = !offer.surface;
    surface.check(offer.meshColor);
    colors.element.hidden = !offer.points;
    colors.check(state.color);
    size.element.hidden = eyeDome.hidden = !offer.pointLooks;
    size.show(state.pointSize_percent);
    coverage.hidden = !offer.coverage;
    coverage.classList.toggle('in-menu', offer.coverageInMenu);
    node.classList.toggle('running', offer.unfoldable);
    follow.hidden = !offer.follow;
    press(
      [inside, state.hideBacks],
      [eyeDome, state.eyeDome],
      [follow, state.follow],
      [coverage, state.coverage],
    );
  };
  const unsubscribers = [options.subscribe(refresh), scan.subscribe(refresh)];
  return {
    element: node,
    dispose() {
      for (const unsubscribe of unsubscribers) unsubscribe();
    },
  };
}

function controlsOf(
  options: Pick<OptionsStore, 'get' | 'dispatch'>,
  frameAll: () => void,
  more: readonly HTMLElement[],
) {
  const show = segments('show', t.whatIsShown, shows, showLabels, (chosen) =>
    options.dispatch({ show: chosen }),
  );
  const colors = segments('color', t.colourOfThePoints, colorModes, colorLabels, (color) =>
    options.dispatch({ color }),
  );
  const surface = segments(
    'mesh-color',
    t.colourOfTheSurface,
    meshColors,
    meshColorLabels,
    (meshColor) => options.dispatch({ meshColor }),
  );
  const size = pointSizeSlider(options);
  const inside = toggle(t.seeInside, t.makesWhatIsSeenFromBehind, () =>
    options.dispatch({ hideBacks: !options.get().hideBacks }),
  );
  const eyeDome = toggle(t.edges, t.eyeDomeLightingPointsAreDarker, () =>
    options.dispatch({ eyeDome: !options.get().eyeDome }),
  );
  const follow = toggle(t.followCamera, t.ridesBehindTheScanningCamera, () =>
    options.dispatch({ follow: !options.get().follow }),
  );
  const coverage = toggle(t.coverage, t.whatWasScannedWellAndWhat, () =>
    options.dispatch({ coverage: !options.get().coverage }),
  );
  coverage.classList.add('coverage-button');
  const frame = buttonOf(t.showAll, { title: t.showsTheWholeScanF });
  frame.addEventListener('click', frameAll);
  const unfold = unfoldButton(() => node.classList.toggle('unfolded'));
  const node = element(
    'section',
    { class: 'card view', 'aria-label': t.view },
    show.element,
    unfold,
    surface.element,
    colors.element,
    size.element,
    eyeDome,
    coverage,
    element('div', { class: 'buttons' }, inside, follow, frame),
    ...more,
  );
  return { node, show, surface, colors, size, eyeDome, coverage, inside, follow };
}

function pointSizeSlider(options: Pick<OptionsStore, 'dispatch'>) {
  const input = element('input', { type: 'range', id: 'point-size', ...pointSizeRange_percent });
  const text = element('output', { for: 'point-size' });
  input.addEventListener('input', () =>
    options.dispatch({ pointSize_percent: input.valueAsNumber }),
  );
  return {
    element: element('label', { class: 'slider', for: 'point-size' }, t.size, input, text),
    show(size_percent: number): void {
      input.value = String(size_percent);
      setText(text, `${size_percent} %`);
    },
  };
}

// On a phone, while a scan runs and the model needs the room.
function unfoldButton(flip: () => boolean): HTMLButtonElement {
  const button = buttonOf(t.view, { class: 'button unfold', 'aria-expanded': 'false' });
  button.addEventListener('click', () => button.setAttribute('aria-expanded', String(flip())));
  return button;
}

function press(...buttons: readonly (readonly [HTMLButtonElement, boolean])[]): void {
  for (const [button, on] of buttons) button.setAttribute('aria-pressed', String(on));
}

function toggle(text: string, title: string, flip: () => void): HTMLButtonElement {
  const button = buttonOf(text, { title, 'aria-pressed': 'false' });
  button.addEventListener('click', flip);
  return button;
}
