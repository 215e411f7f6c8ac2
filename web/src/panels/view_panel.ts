// How the scan is shown: colour, point size, what is seen through, who leads the eye.
import { colorModes, pointSizeRange_mm, type ColorMode, type ViewOptions } from '../state/view_options';
import type { Store } from '../state/store';
import { element, setText, type Panel } from './dom';

const colorLabels: Record<ColorMode, string> = { rgb: 'Colour', normal: 'Normals', confidence: 'Confidence' };

export function viewPanel(options: Store<ViewOptions, Partial<ViewOptions>>, frameAll: () => void): Panel {
  const colors = colorModes.map((mode) => colorChoice(mode, () => options.dispatch({ color: mode })));
  const size = element('input', { type: 'range', id: 'point-size', ...pointSizeRange_mm });
  const sizeText = element('output', { for: 'point-size' });
  size.addEventListener('input', () => options.dispatch({ pointSize_mm: size.valueAsNumber }));
  const inside = toggle('See inside', 'Hides surfaces seen from behind, so that walls do not cover the room', () =>
    options.dispatch({ hideBacks: !options.get().hideBacks }),
  );
  const follow = toggle('Follow camera', 'Rides behind the scanning camera', () => options.dispatch({ follow: !options.get().follow }));
  const frame = element('button', { type: 'button', class: 'button', title: 'Shows the whole scan (F)' }, 'Show all');
  frame.addEventListener('click', frameAll);

  const node = element(
    'section',
    { class: 'card view', 'aria-label': 'View' },
    element('fieldset', { class: 'segments' }, element('legend', { class: 'unseen' }, 'Colour of the points'), ...colors.map((c) => c.label)),
    element('label', { class: 'slider', for: 'point-size' }, 'Size', size, sizeText),
    element('div', { class: 'buttons' }, inside, follow, frame),
  );
  const unsubscribe = options.subscribe((state) => {
    colors.forEach((choice, i) => (choice.input.checked = colorModes[i] === state.color));
    size.value = String(state.pointSize_mm);
    setText(sizeText, `${state.pointSize_mm} mm`);
    inside.setAttribute('aria-pressed', String(state.hideBacks));
    follow.setAttribute('aria-pressed', String(state.follow));
  });
  return { element: node, dispose: unsubscribe };
}

function colorChoice(mode: ColorMode, choose: () => void): { label: HTMLElement; input: HTMLInputElement } {
  const input = element('input', { type: 'radio', name: 'color', value: mode });
  input.addEventListener('change', choose);
  return { label: element('label', {}, input, element('span', {}, colorLabels[mode])), input };
}

function toggle(text: string, title: string, flip: () => void): HTMLButtonElement {
  const button = element('button', { type: 'button', class: 'button', title, 'aria-pressed': 'false' }, text);
  button.addEventListener('click', flip);
  return button;
}
