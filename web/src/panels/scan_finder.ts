// What somebody looks for among the scans: words of the title, tags, and in which order.
import type { ScanSummary } from '../connection/api';
import { found, sorted, sortNames, tagged, tagsOf, type SortName } from '../state/scan_list';
import { t } from '../texts/texts';
import { buttonOf, element } from './dom';

const searchedFrom = 2; // scans; one is found without
const sortLabels: Record<SortName, string> = {
  newest: t.newestFirst,
  oldest: t.oldestFirst,
  title: t.byTitle,
  frames: t.mostFrames,
};

export interface ScanFinder {
  readonly elements: readonly HTMLElement[];
  text(): string; // that titles are searched for
  find(scans: readonly ScanSummary[]): readonly ScanSummary[]; // offers their tags
  hide(): void;
}

export function scanFinder(changed: () => void): ScanFinder {
  const search = element('input', {
    type: 'search',
    placeholder: t.search,
    'aria-label': t.searchTheTitlesOfScans,
    autocomplete: 'off',
  });
  const order = element(
    'select',
    { 'aria-label': t.orderOfTheScans },
    ...sortNames.map((name) => element('option', { value: name }, sortLabels[name])),
  );
  const node = element('div', { class: 'finder' }, search, order);
  const filter = tagFilter(changed);
  node.hidden = true;
  search.addEventListener('input', changed);
  order.addEventListener('change', changed);
  return {
    elements: [node, filter.element],
    text: () => search.value,
    find(scans) {
      node.hidden = scans.length < searchedFrom;
      filter.offer(tagsOf(scans));
      return node.hidden
        ? scans
        : sorted(found(tagged(scans, filter.chosen), search.value), order.value as SortName);
    },
    hide() {
      node.hidden = true;
      filter.offer([]);
    },
  };
}

interface TagFilter {
  readonly element: HTMLElement;
  readonly chosen: ReadonlySet<string>;
  // What is chosen and not offered any more is not chosen any more.
  offer(tags: readonly string[]): void;
}

// A button for each tag; scans need all that are pressed.
function tagFilter(changed: () => void): TagFilter {
  const chosen = new Set<string>();
  const group = element('div', {
    class: 'tags',
    role: 'group',
    'aria-label': t.onlyScansWithTheseTags,
  });
  let offered = '';
  const buttonFor = (tag: string): HTMLElement => {
    const button = buttonOf(tag, { class: 'tag', 'aria-pressed': String(chosen.has(tag)) });
    button.addEventListener('click', () => {
      if (!chosen.delete(tag)) chosen.add(tag);
      button.setAttribute('aria-pressed', String(chosen.has(tag)));
      changed();
    });
    return button;
  };
  group.hidden = true;
  return {
    element: group,
    chosen,
    offer(tags) {
      if (offered === JSON.stringify(tags)) return;
      offered = JSON.stringify(tags);
      for (const tag of chosen) if (!tags.includes(tag)) chosen.delete(tag);
      group.hidden = tags.length === 0;
      group.replaceChildren(...tags.map(buttonFor));
    },
  };
}
