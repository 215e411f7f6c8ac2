import { readdirSync, readFileSync } from 'node:fs';
import ts from 'typescript';
import { describe, expect, it } from 'vitest';
import { de } from './de';
import { en } from './en';
import { decimal, languageOf, localeOf, storeLanguage } from './texts';

describe('the tables of texts', () => {
  const english: Readonly<Record<string, unknown>> = en;
  const german: Readonly<Record<string, unknown>> = de;
  it('have the same texts with the same gaps', () => {
    expect(Object.keys(german)).toEqual(Object.keys(english));
    const gapsOf = (text: unknown): number => (typeof text === 'function' ? text.length : 0);
    for (const [key, text] of Object.entries(english))
      expect([key, gapsOf(german[key])]).toEqual([key, gapsOf(text)]);
  });
  it('fill every gap, and leave no text empty', () => {
    const values = ['<1>', '<2>', '<3>', '<4>'];
    for (const table of [english, german])
      for (const [key, text] of Object.entries(table)) {
        const said =
          typeof text === 'function'
            ? (text as (...values: string[]) => string)(...values)
            : (text as string);
        expect(said, key).not.toBe('');
        if (typeof text === 'function')
          for (const value of values.slice(0, text.length)) expect(said, key).toContain(value);
      }
  });
});

describe('the language', () => {
  it('is the chosen one, else the first one of the browser that there is, else English', () => {
    expect(languageOf('de', ['en-US'])).toBe('de');
    expect(languageOf(null, ['fr-FR', 'de-AT', 'en'])).toBe('de');
    expect(languageOf('xx', ['fr'])).toBe('en');
    expect(languageOf('constructor', [])).toBe('en');
    expect(languageOf(null, [])).toBe('en');
  });
  it('has the numbers and dates of the region', () => {
    expect(localeOf('de', ['en-US', 'de-AT'])).toBe('de-AT');
    expect(localeOf('de', ['de'])).toBe('de-DE');
    expect(localeOf('en', ['de-DE'])).toBe('en-GB');
    expect(decimal(1.25, 1)).toMatch(/^1\.[23]$/);
  });
  it('is kept where the browser keeps something', () => {
    const kept = new Map<string, string>();
    storeLanguage({ setItem: (name, value) => void kept.set(name, value) }, 'de');
    expect([...kept.values()]).toEqual(['de']);
    const full = {
      setItem: () => {
        throw new Error('quota');
      },
    };
    expect(() => storeLanguage(full, 'de')).not.toThrow();
  });
});

// What looks like words for people: several words, or one with a capital letter. Names of keys,
// classes and the program are none.
const looksLikeText = /[A-Za-z]{2,} [a-z–’(]|^[A-Z][a-z]+[.…:]?$|^[A-Z][a-z]+[ :,]/;
const noText = /^(Escape|Backspace|Enter|ArrowLeft|ArrowRight|Hermite|hermite-client .*)$/;
// Names of counts in the report of a scan.
const countNames =
  /^(loops by \w+|\w+ loops|\w+ places|global adjustments|found again|joined parts)$/;

function textsIn(file: string): string[] {
  const source = ts.createSourceFile(file, readFileSync(file, 'utf8'), ts.ScriptTarget.Latest);
  const found: string[] = [];
  const visit = (node: ts.Node): void => {
    if (ts.isImportDeclaration(node) || ts.isLiteralTypeNode(node)) return;
    if (ts.isPropertyAssignment(node) && node.name.getText(source) === 'class') return;
    const text =
      ts.isStringLiteral(node) || ts.isNoSubstitutionTemplateLiteral(node)
        ? node.text
        : ts.isTemplateExpression(node)
          ? node.head.text + node.templateSpans.map(({ literal }) => `1${literal.text}`).join('')
          : '';
    if (looksLikeText.test(text) && !noText.test(text) && !countNames.test(text))
      found.push(`${file}: ${text}`);
    ts.forEachChild(node, visit);
  };
  visit(source);
  return found;
}

it('no panel has a text of its own', () => {
  const panels = readdirSync('src/panels').map((name) => `src/panels/${name}`);
  expect(panels.length).toBeGreaterThan(20);
  const withTexts = [
    'text',
    'behind',
    'frames',
    'measuring',
    'noting',
    'section_text',
    'mesh',
    'comparing',
    'quality_facts',
    'quality_text',
    'quantities',
  ];
  const stateTexts = withTexts.map((name) => `src/state/${name}.ts`);
  expect([...panels, ...stateTexts].flatMap(textsIn)).toEqual([]);
  // The check finds what it looks for.
  expect(textsIn('src/texts/en.ts').length).toBeGreaterThan(300);
}, 30_000);
