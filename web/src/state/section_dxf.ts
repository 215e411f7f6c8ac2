// A section for programs that draw: DXF as release 12 has it, which all of
// them read, in metres. Pure.
import { extentOf, type Polyline } from './section';

type Group = readonly [code: number, value: string | number];

const layer = 'SECTION';
const metre = 6; // of $INSUNITS

// `comment`: a comment, for people.
export function dxfOf(lines: readonly Polyline[], comment: string): string {
  const [left, low, right, high] = extentOf(lines);
  const groups: Group[] = [
    [999, plain(comment)],
    ...section('HEADER', [
      ...variable('ACADVER', [[1, 'AC1009']]),
      ...variable('INSUNITS', [[70, metre]]),
      ...variable('EXTMIN', at(left, low)),
      ...variable('EXTMAX', at(right, high)),
    ]),
    ...section('TABLES', [
      ...table('LTYPE', [
        [2, 'CONTINUOUS'],
        [70, 0],
        [3, 'Solid line'],
        [72, 65],
        [73, 0],
        [40, '0.0'],
      ]),
      ...table('LAYER', [
        [2, layer],
        [70, 0],
        [62, 7],
        [6, 'CONTINUOUS'],
      ]),
    ]),
    ...section('ENTITIES', lines.flatMap(entityOf)),
    [0, 'EOF'],
  ];
  return groups.map(([code, value]) => `${String(code).padStart(3)}\r\n${value}\r\n`).join('');
}

function entityOf({ points, closed }: Polyline): Group[] {
  const start = (name: string): Group[] => [
    [0, name],
    [8, layer],
  ];
  if (points.length === 2) return [...start('LINE'), ...at(...points[0]!), ...at(...points[1]!, 1)];
  const head: Group[] = [...start('POLYLINE'), [66, 1], ...at(0, 0), [70, closed ? 1 : 0]];
  return [
    ...head,
    ...points.flatMap((point) => [...start('VERTEX'), ...at(...point)]),
    ...start('SEQEND'),
  ];
}

// `more`: on the codes, of the second end of a line.
function at(x: number, y: number, more = 0): Group[] {
  return [
    [10 + more, x.toFixed(6)],
    [20 + more, y.toFixed(6)],
    [30 + more, '0.0'],
  ];
}

function section(name: string, groups: readonly Group[]): Group[] {
  return [[0, 'SECTION'], [2, name], ...groups, [0, 'ENDSEC']];
}

function variable(name: string, groups: readonly Group[]): Group[] {
  return [[9, `$${name}`], ...groups];
}

// Of one row.
function table(name: string, row: readonly Group[]): Group[] {
  return [[0, 'TABLE'], [2, name], [70, 1], [0, name], ...row, [0, 'ENDTAB']];
}

// A line of ASCII.
function plain(text: string): string {
  return text.replace(/[^\x20-\x7e]/g, '?').slice(0, 250);
}
