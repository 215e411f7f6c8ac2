import { element } from './dom';
import type { Words } from '../state/words';

// A coloured dot and words; the words carry the meaning, the colour only helps.
export function statusMark(): { element: HTMLElement; show(words: Words): void } {
  const text = element('span');
  const node = element('span', { class: 'mark' }, element('span', { class: 'dot', 'aria-hidden': 'true' }), text);
  return {
    element: node,
    show(words) {
      node.dataset['tone'] = words.tone;
      if (text.textContent !== words.text) text.textContent = words.text;
    },
  };
}
