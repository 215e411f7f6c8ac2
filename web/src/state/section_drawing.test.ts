import { describe, expect, it } from 'vitest';
import type { Polyline } from './section';
import { scaleOf, svgOf } from './section_drawing';
import { dxfOf } from './section_dxf';

const room: Polyline = {
  points: [
    [-1, 2],
    [3, 2],
    [3, 5],
    [-1, 5],
  ],
  closed: true,
};
const door: Polyline = {
  points: [
    [0, 2],
    [0, 3],
  ],
  closed: false,
};
const curve: Polyline = {
  points: [
    [0, 0.5],
    [1, 1],
    [2, 1.25],
  ],
  closed: false,
};

describe('svgOf', () => {
  it('is as large on paper as its scale says', () => {
    const svg = svgOf([room, door], { title: 'Room', description: 'Horizontal section' });
    expect(svg).toContain('1:20');
    // The lines are 4 m and 3 m long at 1:20, with margins and a foot.
    expect(svg).toContain('width="220mm" height="192mm" viewBox="0 0 220 192"');
    expect(svg).toContain('transform="matrix(50 0 0 -50 10 160)"');
    expect(svg).toContain('d="M0 0L4 0L4 3L0 3Z"');
    expect(svg).toContain('d="M1 0L1 1"');
    expect(svg).toContain('v2h50v-2'); // a bar of a metre
    expect(svg).toContain('15.00 m of lines');
  });

  it('has titles as text, whatever they are', () => {
    const svg = svgOf([room], { title: '<script>"Küche" & \u0007Bad\'', description: 'a<b' });
    expect(svg).not.toContain('<script>');
    expect(svg).toContain('<title>&lt;script&gt;&quot;Küche&quot; &amp;  Bad&apos;</title>');
  });

  it('chooses the largest scale that fits', () => {
    expect(scaleOf(0.2, 0.2)).toBe(1);
    expect(scaleOf(4, 3)).toBe(20);
    expect(scaleOf(3, 4)).toBe(20);
    expect(scaleOf(10, 8)).toBe(50);
    expect(scaleOf(1e6, 1)).toBe(5000);
  });
});

// The groups of a DXF.
function groupsOf(text: string): [number, string][] {
  const lines = text.split('\r\n');
  expect(lines.pop()).toBe('');
  expect(lines.length % 2).toBe(0);
  return Array.from({ length: lines.length / 2 }, (_, i) => [
    Number(lines[2 * i]),
    lines[2 * i + 1]!,
  ]);
}

describe('dxfOf', () => {
  const groups = groupsOf(dxfOf([room, door, curve], 'Küche'));
  const named = (name: string): number =>
    groups.filter(([code, value]) => code === 0 && value === name).length;

  it('is made of groups: a whole number and a value of its kind', () => {
    for (const [code, value] of groups) {
      expect([0, 1, 2, 3, 6, 8, 9, 10, 11, 20, 21, 30, 31, 40, 62, 66, 70, 72, 73, 999]).toContain(
        code,
      );
      if (code >= 10 && code < 60) expect(value).toMatch(/^-?\d+\.\d+$/);
      if (code >= 60 && code < 80) expect(value).toMatch(/^\d+$/);
    }
    expect(groups.at(-1)).toEqual([0, 'EOF']);
    expect(groups[0]).toEqual([999, 'K?che']);
    expect(named('SECTION')).toBe(named('ENDSEC'));
    expect(named('TABLE')).toBe(named('ENDTAB'));
  });

  it('is in metres, of release 12', () => {
    const headerValue = (name: string): string =>
      groups[groups.findIndex(([code, value]) => code === 9 && value === name) + 1]![1];
    expect(headerValue('$ACADVER')).toBe('AC1009');
    expect(headerValue('$INSUNITS')).toBe('6');
  });

  it('has a line for two points and a polyline for more', () => {
    expect([named('LINE'), named('POLYLINE'), named('SEQEND'), named('VERTEX')]).toEqual([
      1, 2, 2, 7,
    ]);
    const flags = groups.flatMap(([code, value], i) =>
      code === 0 && value === 'POLYLINE' ? [groups.slice(i).find(([of]) => of === 70)![1]] : [],
    );
    expect(flags).toEqual(['1', '0']);
    const first = groups.findIndex(([, value]) => value === 'VERTEX');
    expect(groups.slice(first + 2, first + 5)).toEqual([
      [10, '-1.000000'],
      [20, '2.000000'],
      [30, '0.0'],
    ]);
  });
});
