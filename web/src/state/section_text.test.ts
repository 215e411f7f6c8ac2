import { describe, expect, it } from 'vitest';
import type { Section } from './cutting';
import { line, model } from './section_samples';
import { drawingText, placeText, sectionName, sectionText } from './section_text';

const horizontal: Section = { kind: 'horizontal', at_m: 0.3, turn_deg: 0 };

describe('the texts of a section', () => {
  it('say how much there is, or why there is nothing', () => {
    expect(sectionText({ surface: 'finished', lines: [line] })).toBe(
      '2.50 m of lines in one piece.',
    );
    expect(sectionText({ surface: 'finished', lines: [line, line] })).toBe(
      '5.00 m of lines in 2 pieces.',
    );
    expect(sectionText({ surface: 'finished', lines: [] })).toBe(
      'The plane does not cut the surface.',
    );
    expect(sectionText({ surface: 'growing', lines: [line] })).toMatch(
      /when the surface is finished/,
    );
    expect(sectionText({ surface: 'none', lines: [] })).toMatch(/no surface/);
  });

  it('count from the floor, or from where the model begins', () => {
    expect(placeText(model, horizontal)).toBe('1.200 m');
    expect(placeText(model, { ...horizontal, at_m: -1 })).toBe('−0.100 m');
    expect(placeText(model, { ...horizontal, at_m: -0.9001 })).toBe('0.000 m');
    expect(drawingText(model, { kind: 'vertical', at_m: 0, turn_deg: 0 })).toBe(
      'vertical section at 2.000 m, turned by 0 degrees',
    );
  });

  it('make names of files', () => {
    expect(sectionName(model, horizontal)).toBe('section_horizontal_1.200m');
    expect(sectionName(model, { ...horizontal, at_m: -1 })).toBe('section_horizontal_-0.100m');
    expect(sectionName(model, { kind: 'vertical', at_m: 0, turn_deg: 90 })).toBe(
      'section_vertical_90deg_3.000m',
    );
  });
});
