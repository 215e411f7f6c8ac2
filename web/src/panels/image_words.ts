// What the page says over the image: why it is empty, and what becomes of the surface
// that somebody waits for.
import type { LiveScan } from '../state/live_scan';
import { meshText } from '../state/mesh';
import type { Store } from '../state/store';
import { emptyText } from '../state/text';
import type { ViewOptions } from '../state/view_options';
import { t } from '../texts/texts';
import { element, setText } from './dom';

export interface ImageWords {
  readonly elements: readonly HTMLElement[];
  dispose(): void;
}

// `canDraw`: the browser can show pictures in three dimensions.
export function imageWords(
  scan: Store<LiveScan, never>,
  options: Store<ViewOptions, never>,
  canDraw: boolean,
): ImageWords {
  const empty = element('p', { class: 'empty', role: 'status' });
  const surface = element('p', { class: 'mesh-note', role: 'status' });
  const refresh = (): void => {
    say(empty, canDraw ? emptyText(scan.get()) : t.thisBrowserCannotShow3dPictures);
    say(surface, meshText(scan.get().mesh, options.get().show === 'surface') || null);
  };
  const unsubscribers = [scan.subscribe(refresh), options.subscribe(refresh)];
  return {
    elements: [empty, surface],
    dispose() {
      for (const unsubscribe of unsubscribers) unsubscribe();
    },
  };
}

function say(node: HTMLElement, text: string | null): void {
  node.hidden = text === null;
  if (text !== null) setText(node, text);
}
