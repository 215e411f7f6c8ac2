// Says that more follows below in what scrolls: it fades at its lower edge (.more-below).

const least_px = 4; // rounded away otherwise

export const isAtEnd = ({ scrollTop, scrollHeight, clientHeight }: HTMLElement): boolean =>
  scrollHeight - clientHeight - scrollTop < least_px;

// Returns what ends it.
export function hintAtMore(scrolled: HTMLElement): () => void {
  const look = (): void => {
    scrolled.classList.toggle('more-below', !isAtEnd(scrolled));
  };
  const sizes = new ResizeObserver(look);
  for (const node of [scrolled, ...scrolled.children]) sizes.observe(node);
  scrolled.addEventListener('scroll', look, { passive: true });
  return () => {
    sizes.disconnect();
    scrolled.removeEventListener('scroll', look);
  };
}
