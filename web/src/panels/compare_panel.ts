// Beside the image of a comparison: what it says, what the colours mean, and the
// list of what has changed.
import type { ChangedRegion, CompareReport } from '../connection/comparisons';
import {
  changeColor,
  colorOfDistance,
  cssOf,
  fullColor_m,
  kindOf,
  remarksOf,
  sizeOf,
  verdictOf,
  type Look,
} from '../state/comparing';
import { millimetresText } from '../state/quantities';
import { t } from '../texts/texts';
import { element, setText } from './dom';

const legendSteps = 10; // to either side

export interface ComparePanel {
  readonly element: HTMLElement;
  show(report: CompareReport): void;
  showLook(look: Look): void;
  choose(region: number | null): void;
}

// `chosen` is called with the index of the region in the report.
export function comparePanel(chosen: (region: number) => void): ComparePanel {
  const verdict = element('p', { class: 'lead', role: 'status' });
  const legend = legendOf();
  const list = element('ol', { class: 'compare-regions' });
  const remarks = element('ul', { class: 'compare-remarks' });
  const details = element('details', {}, element('summary', {}, t.details), remarks);
  const heading = element('h2', {}, t.changes);
  const node = element(
    'section',
    { class: 'compare-panel', 'aria-label': t.whatHasChanged },
    verdict,
    legend,
    heading,
    list,
    details,
  );
  node.hidden = true;
  let buttons: HTMLButtonElement[] = [];
  const rowOf = (region: ChangedRegion, index: number): HTMLButtonElement => {
    const color = changeColor(
      region.kind === 'added' || region.kind === 'removed' ? region.kind : 'moved',
      region.distance_m,
    );
    const dot = element('span', { class: 'compare-color', 'aria-hidden': 'true' });
    if (color) dot.style.background = cssOf(color);
    const button = element(
      'button',
      {
        type: 'button',
        class: 'menu-row compare-region',
        'aria-pressed': 'false',
        title: t.showsItInThePicture,
      },
      dot,
      element('span', { class: 'compare-kind' }, kindOf(region)),
      element('span', { class: 'compare-size' }, sizeOf(region)),
    );
    button.addEventListener('click', () => chosen(index));
    return button;
  };
  return {
    element: node,
    show(report) {
      node.hidden = false;
      setText(verdict, verdictOf(report));
      const isSame = report.verdict === 'same_place';
      legend.hidden = !isSame;
      heading.hidden = list.hidden = report.regions.length === 0;
      buttons = report.regions.map(rowOf);
      list.replaceChildren(...buttons.map((button) => element('li', {}, button)));
      remarks.replaceChildren(...remarksOf(report).map((text) => element('li', {}, text)));
      details.open = !isSame;
    },
    showLook(look) {
      node.classList.toggle('sides', look === 'sides'); // greys stand in the overlay alone
    },
    choose(region) {
      buttons.forEach((button, i) => button.setAttribute('aria-pressed', String(i === region)));
    },
  };
}

function legendOf(): HTMLElement {
  const bar = element('div', { class: 'compare-bar', 'aria-hidden': 'true' });
  for (let step = -legendSteps; step <= legendSteps; ++step) {
    const piece = element('span');
    piece.style.background = cssOf(colorOfDistance(((step || 0.5) / legendSteps) * fullColor_m));
    bar.append(piece);
  }
  const most = millimetresText(fullColor_m, 0);
  const ends = element(
    'div',
    { class: 'compare-ends' },
    element('span', {}, t.fartherBy(most)),
    element('span', {}, t.nearerBy(most)),
  );
  const chips = (['added', 'removed'] as const).map((state) =>
    chip(state === 'added' ? t.added : t.removed, cssOf(changeColor(state, NaN)!)),
  );
  const greys = [
    chip(t.unchanged, 'rgb(168 168 168)', 'grey'),
    chip(t.notSeenInTheOtherScan, 'rgb(64 64 64)', 'grey'),
  ];
  return element(
    'div',
    { class: 'compare-legend', role: 'group', 'aria-label': t.whatTheColoursMean },
    bar,
    ends,
    element('ul', {}, ...chips, ...greys),
  );
}

function chip(label: string, color: string, kind = ''): HTMLElement {
  const dot = element('span', { class: 'compare-color', 'aria-hidden': 'true' });
  dot.style.background = color;
  return element('li', { class: kind }, dot, label);
}
