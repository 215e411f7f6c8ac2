// Lengths and times in German, and the texts that have them.
import { expect, it, vi } from 'vitest';
import { asItIs } from '../connection/exports';
import { fullColor_m } from './comparing';
import { behindText } from './behind';
import type { Section } from './cutting';
import { timeText } from './frames';
import { svgOf } from './section_drawing';
import { line, model } from './section_samples';
import { drawingText, placeText, sectionName, sectionText } from './section_text';
import {
  clockText,
  durationText,
  exactNumber,
  lengthText,
  metresText,
  millimetresText,
  millisecondsText,
  roundedUpText,
  secondsText,
  timestampText,
  withinText,
} from './quantities';
import { finishText } from './text';

// Texts are in the language of the browser, which is asked when they are loaded:
// before the imports above.
vi.hoisted(() => {
  vi.stubGlobal('document', {});
  vi.stubGlobal('navigator', { languages: ['de-DE'] });
});

it('writes lengths with a comma', () => {
  expect([1.2, -0.1, -0.0001, 1234.5].map((length_m) => metresText(length_m, 3))).toEqual([
    '1,200 m',
    '−0,100 m',
    '0,000 m',
    '1.234,500 m',
  ]);
  expect([millimetresText(0.0234, 1), millimetresText(fullColor_m, 0)]).toEqual([
    '23,4 mm',
    '50 mm',
  ]);
  expect([0.0005, 0.125, 2.5].map(lengthText)).toEqual(['0,5 mm', '12,5 cm', '2,5 m']);
  expect([0.0021, 0.0123, 1.26].map(roundedUpText)).toEqual(['3 mm', '2 cm', '1,3 m']);
  expect(withinText(0.7)).toBe('± 1,4 m');
  expect(exactNumber(22.5)).toBe('22,5');
});

it('writes times with a comma', () => {
  expect([0.01, 0.8, 75, 3700].map(durationText)).toEqual([
    'weniger als 0,1 s',
    '0,8 s',
    '1 min 15 s',
    '1 h 1 min',
  ]);
  expect([0.9, 9.4].map(secondsText)).toEqual(['weniger als einer Sekunde', '9 s']);
  expect(millisecondsText(1234.5)).toMatch(/^1\.23[45] ms$/);
  expect([0, 62.34].map((at_s) => clockText(at_s))).toEqual(['0:00,0', '1:02,3']);
  expect(clockText(62.0334, 3)).toBe('1:02,033');
  expect(timestampText(1700000000.125)).toBe('1700000000,125 s');
  expect(
    timeText(
      { timestamps_s: [100, 101.2], statuses: ['tracked', 'tracked'], reasons: ['', ''] },
      1,
    ),
  ).toBe('0:01,200');
  expect(behindText({ image_ms: 20, model_ms: 950, server_ms: 900, way_ms: 10 })).toContain(
    'Modell 1,0 s, Bilder weniger als 0,1 s',
  );
});

const section: Section = { kind: 'vertical', at_m: 0, turn_deg: 22.5 };

it('tells of a section in German, whose file has the same name in every language', () => {
  expect(sectionText({ surface: 'finished', lines: [line] })).toBe('2,50 m Linien in einem Stück.');
  expect(placeText(model, { kind: 'horizontal', at_m: 0.3, turn_deg: 0 })).toBe('1,200 m');
  expect(drawingText(model, section)).toMatch(
    /^senkrechter Schnitt bei \d,\d{3} m, um 22,5 Grad gedreht$/,
  );
  expect(sectionName(model, { kind: 'horizontal', at_m: -0.9001, turn_deg: 0 })).toBe(
    'section_horizontal_0.000m',
  );
  expect(sectionName(model, section)).toMatch(/^section_vertical_22\.5deg_\d\.\d{3}m$/);
});

it('draws a section with German words and the numbers of SVG', () => {
  const svg = svgOf([line], { title: 'Küche', description: drawingText(model, section) });
  expect(svg).toContain('1:5, 2,50 m Linien</text>');
  expect(svg).toContain('Die Linien sind in Metern');
  expect(svg).toContain('d="M0 0L1 0L1 1.5"');
});

it('tells how a mesh was finished', () => {
  expect(finishText({ ...asItIs, simplify_um: 500, fill_holes_mm: 125 })).toBe(
    'auf 0,5 mm vereinfacht, Löcher bis 12,5 cm gefüllt',
  );
});
