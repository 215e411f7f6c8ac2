// On a phone the panels cover much of the image: what somebody looks at stays in
// the middle of what is left.
import { freePart, wholeImage } from '../scene/free_part';
import type { ScanScene } from '../scene/scene';

const ofPhones = '(max-width: 820px), (max-height: 500px)'; // as style.css has it

// `page`: with all its panels. Returns what ends it.
export function watchFreePart(page: HTMLElement, stage: HTMLElement, scene: ScanScene): () => void {
  const phone = matchMedia(ofPhones);
  const panels = [...page.querySelectorAll<HTMLElement>(':scope > .card')];
  const look = (): void => {
    const edges = (phone.matches ? panels : []).map((panel) => panel.getBoundingClientRect());
    scene.setFreePart(
      edges.length > 0 ? freePart(stage.getBoundingClientRect(), edges) : wholeImage,
    );
  };
  const sizes = new ResizeObserver(look);
  for (const node of [stage, ...panels]) sizes.observe(node);
  return () => sizes.disconnect();
}
