import { element } from './dom';
import type { StatusText } from '../state/text';

// A coloured dot and text; the text carries the meaning, the colour only helps.
export function statusMark(): { element: HTMLElement; show(status: StatusText): void } {
  const text = element('span');
  const node = element(
    'span',
    { class: 'mark' },
    element('span', { class: 'dot', 'aria-hidden': 'true' }),
    text,
  );
  return {
    element: node,
    show(status) {
      node.dataset['tone'] = status.tone;
      if (text.textContent !== status.text) text.textContent = status.text;
    },
  };
}
