// A card that a button opens and closes. It also closes by a click elsewhere and by Escape.

export interface PopUp {
  readonly isOpen: () => boolean;
  dispose(): void;
}

interface Parts {
  readonly node: HTMLElement; // has the button and the card: a click in it is none elsewhere
  readonly button: HTMLElement;
  readonly card: HTMLElement;
  readonly close: HTMLElement; // a button in the card
  readonly opened: () => void;
}

export function popUp({ node, button, card, close, opened }: Parts): PopUp {
  const open = (on: boolean): void => {
    card.hidden = !on;
    button.setAttribute('aria-expanded', String(on));
    if (on) opened();
  };
  const goBack = (): void => {
    open(false);
    button.focus();
  };
  const onOutside = (event: Event): void => {
    if (!card.hidden && event.target instanceof Node && !node.contains(event.target)) open(false);
  };
  const onKey = (event: KeyboardEvent): void => {
    if (event.key === 'Escape' && !card.hidden) goBack();
  };
  card.hidden = true;
  button.addEventListener('click', () => open(card.hidden));
  close.addEventListener('click', goBack);
  document.addEventListener('pointerdown', onOutside);
  document.addEventListener('keydown', onKey);
  return {
    isOpen: () => !card.hidden,
    dispose() {
      document.removeEventListener('pointerdown', onOutside);
      document.removeEventListener('keydown', onKey);
    },
  };
}
