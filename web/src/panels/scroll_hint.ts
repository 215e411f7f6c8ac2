// Says that more follows below in what scrolls: it fades at its lower edge (.more-below).

const least_px = 4; // rounded away otherwise

// Returns what ends it.
export function hintAtMore(scrolled: HTMLElement): () => void {
  const look = (): void => {
    const { scrollTop, scrollHeight, clientHeight } = scrolled;
    scrolled.classList.toggle('more-below', scrollHeight - clientHeight - scrollTop >= least_px);
  };
  const sizes = new ResizeObserver(look);
  for (const node of [scrolled, ...scrolled.children]) sizes.observe(node);
  scrolled.addEventListener('scroll', look, { passive: true });
  return () => {
    sizes.disconnect();
    scrolled.removeEventListener('scroll', look);
  };
}
