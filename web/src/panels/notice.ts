// A line that is there while it has something to say.
import { element, setText } from './dom';

export interface Notice {
  readonly element: HTMLElement;
  say(text: string): void; // an empty text hides it
}

export function noticeLine(): Notice {
  const node = element('p', { class: 'notice', role: 'status', hidden: true });
  return {
    element: node,
    say(text) {
      node.hidden = text === '';
      setText(node, text);
    },
  };
}
