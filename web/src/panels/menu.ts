// A button that opens a short list of things to do. Closes by itself.
import { buttonOf, element, type Panel } from './dom';

export interface MenuItem {
  readonly label: string;
  readonly bad?: boolean; // it takes something away
  readonly phoneOnly?: boolean; // elsewhere there is a button for it
  do(): void;
}

export interface Menu extends Panel {
  isOpen(): boolean;
}

// `items` is asked whenever it opens. Without any the button is left out.
export function menu(label: string, items: () => readonly MenuItem[]): Menu {
  const list = element('div', { class: 'card menu-list' });
  const button = buttonOf(element('span', { 'aria-hidden': 'true' }, '⋯'), {
    class: 'button menu-button',
    'aria-label': label,
    'aria-haspopup': 'true',
    'aria-expanded': 'false',
  });
  const node = element('div', { class: 'menu' }, button, list);
  list.hidden = true;
  const open = (on: boolean): void => {
    if (on) list.replaceChildren(...items().map((item) => rowOf(item, () => open(false))));
    list.hidden = !on;
    button.setAttribute('aria-expanded', String(on));
    if (on) list.querySelector('button')?.focus();
  };
  const onOutside = (event: Event): void => {
    if (!list.hidden && event.target instanceof Node && !node.contains(event.target)) open(false);
  };
  const onKey = (event: KeyboardEvent): void => {
    if (list.hidden) return;
    const step = event.key === 'ArrowDown' ? 1 : event.key === 'ArrowUp' ? -1 : 0;
    if (event.key !== 'Escape' && step === 0) return;
    event.preventDefault();
    if (step === 0) {
      open(false);
      button.focus();
      return;
    }
    const rows = [...list.querySelectorAll('button')];
    const at = rows.indexOf(document.activeElement as HTMLButtonElement);
    rows[(at + step + rows.length) % rows.length]?.focus();
  };
  button.addEventListener('click', () => open(list.hidden));
  document.addEventListener('pointerdown', onOutside);
  node.addEventListener('keydown', onKey);
  return {
    element: node,
    isOpen: () => !list.hidden,
    dispose() {
      document.removeEventListener('pointerdown', onOutside);
    },
  };
}

function rowOf(item: MenuItem, close: () => void): HTMLElement {
  const row = buttonOf(item.label, {
    class: `menu-row${item.bad ? ' bad' : ''}${item.phoneOnly ? ' phone-only' : ''}`,
  });
  row.addEventListener('click', () => {
    close();
    item.do();
  });
  return row;
}
