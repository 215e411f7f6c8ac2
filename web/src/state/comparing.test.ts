import { describe, expect, it } from 'vitest';
import type { ComparedChunk } from '../connection/compared_points';
import type { ChangedRegion, CompareReport } from '../connection/comparisons';
import {
  changeColor,
  colorOfDistance,
  colorsOf,
  isShown,
  ordered,
  remarksOf,
  sizeOf,
  verdictOf,
} from './comparing';

const region: ChangedRegion = {
  kind: 'moved_towards',
  area_m2: 0.044,
  distance_m: 0.0203,
  sigma_m: 0.0011,
  low_m: [0, 0, 0],
  high_m: [1, 1, 1],
};
const report: CompareReport = {
  verdict: 'same_place',
  agreeingShare: 0.98,
  overlap: 0.7,
  weakestSigma_m: 0.0005,
  leastChange_m: 0.01,
  comparedArea_m2: 12.34,
  unseenArea_m2: 2,
  partCounts: [1, 2],
  pathsKnown: [true, false],
  regions: [region],
};

describe('the texts of a comparison', () => {
  it('say what has changed', () => {
    expect(verdictOf(report)).toBe('One change on 12.3 m² that both scans saw.');
    expect(verdictOf({ ...report, regions: [] })).toContain('Nothing has changed');
    expect(verdictOf({ ...report, regions: [region, region] })).toContain('2 changes');
    expect(sizeOf(region)).toBe('20.3 mm ± 2.2 mm, 440 cm²');
    expect(sizeOf({ ...region, kind: 'added', area_m2: 1.5 })).toBe('1.50 m²');
  });
  it('say why there is no image', () => {
    expect(verdictOf({ ...report, verdict: 'mirrored' })).toContain('mirrored');
    expect(verdictOf({ ...report, verdict: 'ambiguous' })).toContain('more than one way');
    expect(verdictOf({ ...report, verdict: 'too_sparse' })).toContain('too far apart');
    expect(verdictOf({ ...report, verdict: 'different_places' })).toContain(
      'do not show the same place',
    );
    expect(remarksOf({ ...report, verdict: 'ambiguous' })).toEqual([
      'In the best position that was found, 98 % of what both saw agrees, and 70 % of the smaller scan lies in the other one.',
    ]);
  });
  it('say what is not known', () => {
    const remarks = remarksOf(report).join(' ');
    expect(remarks).toContain('Nothing could be called removed');
    expect(remarks).not.toContain('Nothing could be called added');
    expect(remarks).toContain('2.0 m² of the first scan were not seen');
    expect(remarks).toContain('The second scan is in 2 parts');
    expect(remarks).not.toContain('The first scan is in');
  });
});

describe('the colours of a comparison', () => {
  const chunk = (scan: 0 | 1): ComparedChunk => ({
    scan,
    cube: [0, 0, 0],
    points: {
      count: 5,
      positions_m: new Float32Array(15),
      colors: Uint8Array.from([1, 2, 3, 4, 5].flatMap(() => [200, 100, 60, 255])),
      normals: new Int8Array(20),
      radii_m: new Float32Array(5),
      min_m: [0, 0, 0],
      max_m: [0, 0, 0],
    },
    states: Uint8Array.of(0, 1, 2, 3, 4),
    distances_m: Float32Array.of(NaN, 0.002, -0.05, NaN, NaN),
  });
  it('are red towards the camera and blue away from it, fuller the farther', () => {
    const [near, far] = [colorOfDistance(0.05), colorOfDistance(-0.05)];
    expect(near[0]).toBeGreaterThan(near[2] + 100);
    expect(far[2]).toBeGreaterThan(far[0] + 100);
    expect(colorOfDistance(0.2)).toEqual(near);
    expect(colorOfDistance(0.01)[1]).toBeGreaterThan(near[1]);
    expect(changeColor('same', 0.03)).toBeNull();
    expect(changeColor('moved', NaN)).toBeNull();
  });
  it('are grey one over the other where nothing is known or has changed', () => {
    const colors = colorsOf(chunk(0), 'overlay');
    const grey = (i: number): boolean =>
      colors[4 * i] === colors[4 * i + 1] && colors[4 * i] === colors[4 * i + 2];
    expect([0, 1, 2, 3, 4].map(grey)).toEqual([true, true, false, false, false]);
    expect(colors[0]).toBeLessThan(colors[4]!);
  });
  it('are the own ones side by side where nothing has changed', () => {
    const colors = colorsOf(chunk(1), 'sides');
    expect([...colors.slice(0, 8)]).toEqual([200, 100, 60, 255, 200, 100, 60, 255]);
    expect(colors.slice(16, 19)).not.toEqual(Uint8Array.of(200, 100, 60));
  });
  it('over the first scan show of the second what the first has not', () => {
    expect([
      isShown(0, 'same', 0, 'overlay'),
      isShown(1, 'same', 0, 'overlay'),
      isShown(1, 'added', NaN, 'overlay'),
      isShown(1, 'unseen', NaN, 'overlay'),
      isShown(1, 'same', 0, 'sides'),
    ]).toEqual([true, false, true, true, true]);
  });
});

it('the older scan is the first', () => {
  const [old, young] = [
    { id: 'b', started: new Date(1) },
    { id: 'a', started: new Date(2) },
  ];
  expect(ordered(old, young)).toEqual([old, young]);
  expect(ordered(young, old)).toEqual([old, young]);
  const [x, y] = [
    { id: 'x', started: null },
    { id: 'y', started: null },
  ];
  expect(ordered(y, x)).toEqual([x, y]);
});
