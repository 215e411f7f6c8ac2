// The texts that a person reads, in the language that was chosen, else in the first one of the
// browser that there is a table of. It stays the same as long as a page is open: who chooses
// another one loads the page again.
import { de } from './de';
import { en, type Texts } from './en';
import { ofThisBrowser } from '../state/storages';

// By their names in themselves.
export const languages = { en: 'English', de: 'Deutsch' } as const;
export type Language = keyof typeof languages;

const tables: Record<Language, Texts> = { en, de };
const usualLocales: Record<Language, string> = { en: 'en-GB', de: 'de-DE' };
const storedAs = 'hermite.language';

const isLanguage = (name: string): name is Language => Object.hasOwn(tables, name);
const languageIn = (tag: string): string => tag.toLowerCase().split('-')[0]!;

// `chosen`: stored, or null. `wanted`: tags of the browser, the best first.
export function languageOf(chosen: string | null, wanted: readonly string[]): Language {
  if (chosen !== null && isLanguage(chosen)) return chosen;
  return wanted.map(languageIn).find(isLanguage) ?? 'en';
}

// For numbers and dates: that of the browser where it is of this language.
export function localeOf(shown: Language, wanted: readonly string[]): string {
  return (
    wanted.find((tag) => languageIn(tag) === shown && tag.includes('-')) ?? usualLocales[shown]
  );
}

export function storeLanguage(storage: Pick<Storage, 'setItem'>, shown: Language): void {
  try {
    storage.setItem(storedAs, shown);
  } catch {
    // A browser that keeps nothing.
  }
}

// Tests without a page are in English.
const preferred = typeof document === 'undefined' ? [] : navigator.languages;
export const language = languageOf(
  typeof document === 'undefined' ? null : ofThisBrowser.getItem(storedAs),
  preferred,
);
export const locale = localeOf(language, preferred);
export const t: Texts = tables[language];

export function decimal(value: number, digits: number): string {
  return value.toLocaleString(locale, {
    minimumFractionDigits: digits,
    maximumFractionDigits: digits,
  });
}
