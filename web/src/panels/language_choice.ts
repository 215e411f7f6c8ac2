// In which language the page is. The choice is kept, and the page is loaded again in it.
import { language, languages, storeLanguage, t, type Language } from '../texts/texts';
import { element } from './dom';
import { ofThisBrowser } from '../state/storages';

const names = Object.entries(languages) as [Language, string][];

export function chooseLanguage(chosen: Language): void {
  storeLanguage(ofThisBrowser, chosen);
  location.reload();
}

export function languageChoice(): HTMLElement {
  const select = element('select', { class: 'language', 'aria-label': t.language });
  for (const [value, name] of names)
    select.append(element('option', { value, lang: value, selected: value === language }, name));
  select.addEventListener('change', () => chooseLanguage(select.value as Language));
  return select;
}

// Of those that the page is not in.
export const otherLanguages: readonly [Language, string][] = names.filter(
  ([value]) => value !== language,
);
