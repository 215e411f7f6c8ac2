// A section as a drawing on paper: SVG, with its scale and a bar to check a print by. Pure.
import { t } from '../texts/texts';
import { lengthText, metresText } from './quantities';
import { extentOf, lengthOf, type Polyline } from './section';

export interface Sheet {
  readonly title: string;
  readonly description: string; // what was cut
}

const scales = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000] as const;
const sheet_mm = [380, 237] as const; // of lines on an A3, with a foot
const margin_mm = 10;
const foot_mm = 22;
const leastWidth_mm = 120; // for the text
const line_mm = 0.25;
const roundEnds = 'stroke-linecap="round" stroke-linejoin="round"';
const bars_m = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200] as const;
const longestBar_mm = 60;

// 50 stands for 1:50. The largest at which the lines fit on an A3, either way round.
export function scaleOf(width_m: number, height_m: number): number {
  const [long_mm, short_mm] = [
    1000 * Math.max(width_m, height_m),
    1000 * Math.min(width_m, height_m),
  ];
  return (
    scales.find((scale) => long_mm / scale <= sheet_mm[0] && short_mm / scale <= sheet_mm[1]) ??
    scales[scales.length - 1]!
  );
}

export function svgOf(lines: readonly Polyline[], { title, description }: Sheet): string {
  const [left, low, right, high] = extentOf(lines);
  const scale = scaleOf(right - left, high - low);
  const perMetre_mm = 1000 / scale;
  const [drawn_mm, tall_mm] = [(right - left) * perMetre_mm, (high - low) * perMetre_mm];
  const width_mm = Math.max(drawn_mm + 2 * margin_mm, leastWidth_mm);
  const height_mm = tall_mm + 2 * margin_mm + foot_mm;
  const bar_m =
    [...bars_m].reverse().find((long_m) => long_m * perMetre_mm <= longestBar_mm) ?? bars_m[0];
  // From metres to millimetres, which go downwards on the sheet.
  const place_mm = `${margin_mm} ${short(margin_mm + tall_mm)}`;
  const toPaper = `matrix(${perMetre_mm} 0 0 ${-perMetre_mm} ${place_mm})`;
  const [width, height] = [short(width_mm), short(height_mm)];
  const size = `width="${width}mm" height="${height}mm" viewBox="0 0 ${width} ${height}"`;
  const [bar_mm, bar_y] = [bar_m * perMetre_mm, height_mm - margin_mm - 8];
  const bar = `M${margin_mm} ${short(bar_y - 2)}v2h${short(bar_mm)}v-2`;
  const text = (y: number, say: string): string =>
    `<text x="${margin_mm}" y="${short(y)}">${escaped(say)}</text>`;
  return `<?xml version="1.0" encoding="UTF-8"?>
<svg xmlns="http://www.w3.org/2000/svg" ${size}>
<title>${escaped(title)}</title>
<desc>${escaped(t.linesAreInMetresAtScale(description, scale))}</desc>
<rect width="100%" height="100%" fill="#fff"/>
<g id="section" transform="${toPaper}" ${strokeOf(line_mm / perMetre_mm)} ${roundEnds}>
${lines.map((line) => `<path d="${pathOf(line, left, low)}"/>`).join('\n')}
</g>
<g id="scale-bar" ${strokeOf(line_mm)}><path d="${bar}"/></g>
<g font-family="sans-serif" font-size="3.5" fill="#000">
<text x="${short(margin_mm + bar_mm + 2)}" y="${short(bar_y)}">${lengthText(bar_m)}</text>
${text(bar_y + 6, `${title}: ${description}`)}
${text(bar_y + 11, t.ofLinesAtScale(scale, metresText(lengthOf(lines), 2)))}
</g>
</svg>
`;
}

function strokeOf(width: number): string {
  return `fill="none" stroke="#000" stroke-width="${width}"`;
}

// From the lower left corner of the drawing.
function pathOf({ points, closed }: Polyline, left: number, low: number): string {
  const corners = points.map(([u, v]) => `${metres(u - left)} ${metres(v - low)}`);
  return `M${corners.join('L')}${closed ? 'Z' : ''}`;
}

function metres(value: number): string {
  return String(Number(value.toFixed(5)));
}

function short(value_mm: number): string {
  return String(Number(value_mm.toFixed(3)));
}

// For XML, which knows no control characters.
function escaped(text: string): string {
  const names: Record<string, string> = {
    '&': '&amp;',
    '<': '&lt;',
    '>': '&gt;',
    '"': '&quot;',
    "'": '&apos;',
  };
  return text
    .replace(/[\u0000-\u001f\u007f\ufffe\uffff]/g, ' ')
    .replace(/[&<>"']/g, (letter) => names[letter]!);
}
