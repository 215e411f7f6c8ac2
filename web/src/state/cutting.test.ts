import { describe, expect, it } from 'vitest';
import { axesOf, cross, dot } from './axes';
import { cutQuery, readCut } from './cut_link';
import {
  initialCutting,
  planeOf,
  rangeOf,
  reduceCutting,
  zeroOf,
  type Cutting,
  type CuttingEvent,
  type Model,
} from './cutting';

const axes = { along: [1, 0, 0], up: [0, -1, 0] } as const; // y points down
const model: Model = { axes, low_m: [-2, 0, -3], high_m: [2, 2.5, 3], floor_m: 0.1 };
const play = (...events: CuttingEvent[]): Cutting => events.reduce(reduceCutting, initialCutting);
const begun: CuttingEvent[] = [
  { kind: 'active', active: true },
  { kind: 'measured', model },
];

describe('the clip box', () => {
  it('begins as the bounds of the model', () => {
    expect(play(...begun).clip).toBeNull();
    expect(play(...begun, { kind: 'clip', on: true }).clip).toEqual({
      low_m: model.low_m,
      high_m: model.high_m,
    });
    expect(play({ kind: 'clip', on: true }).clip).toBeNull(); // of nothing
  });

  it('has faces that stay inside of the model and do not pass each other', () => {
    const face = (side: 'low_m' | 'high_m', to_m: number): Cutting =>
      play(...begun, { kind: 'clip', on: true }, { kind: 'face', face: { axis: 1, side }, to_m });
    expect(face('low_m', 1).clip!.low_m).toEqual([-2, 1, -3]);
    expect(face('low_m', -9).clip!.low_m[1]).toBe(0);
    expect(face('low_m', 9).clip!.low_m[1]).toBeCloseTo(2.49);
    expect(face('high_m', -9).clip!.high_m[1]).toBeCloseTo(0.01);
  });

  it('grows with the model until somebody has moved a face', () => {
    const grown: CuttingEvent = { kind: 'measured', model: { ...model, high_m: [5, 2.5, 3] } };
    expect(play(...begun, { kind: 'clip', on: true }, grown).clip!.high_m[0]).toBe(5);
    const moved: CuttingEvent = { kind: 'face', face: { axis: 2, side: 'low_m' }, to_m: 0 };
    expect(play(...begun, { kind: 'clip', on: true }, moved, grown).clip!.high_m[0]).toBe(2);
    expect(
      play(...begun, { kind: 'clip', on: true }, moved, { kind: 'reset', model }).clip!.low_m[2],
    ).toBe(-3);
  });
});

describe('the section plane', () => {
  it('begins 1.2 m above the floor, or in the middle', () => {
    expect(play(...begun, { kind: 'cut', by: 'horizontal' }).section).toEqual({
      kind: 'horizontal',
      at_m: 1.3,
      turn_deg: 0,
    });
    expect(play(...begun, { kind: 'cut', by: 'vertical' }).section!.at_m).toBe(0);
    const low = { ...model, high_m: [2, 1, 3] } as const;
    expect(
      play({ kind: 'measured', model: low }, { kind: 'cut', by: 'horizontal' }).section!.at_m,
    ).toBe(0.5);
    expect(
      play(...begun, { kind: 'cut', by: 'vertical' }, { kind: 'cut', by: 'off' }).section,
    ).toBeNull();
  });

  it('turns about the middle of the model', () => {
    const off = { ...model, low_m: [8, 0, -3], high_m: [12, 2.5, 3] } as const;
    const turned = play(
      { kind: 'measured', model: off },
      { kind: 'cut', by: 'vertical' },
      { kind: 'moved', at_m: 11 },
      { kind: 'turned', turn_deg: 90 },
    ).section!;
    expect(turned.at_m).toBeCloseTo(1);
    expect(rangeOf(off, turned).map((value) => Math.round(value * 1e6) / 1e6)).toEqual([-3, 3]);
    expect(zeroOf(off, turned)).toBeCloseTo(-3);
  });

  it('has a right-handed frame, with up up', () => {
    for (const section of [
      { kind: 'horizontal', at_m: 1, turn_deg: 0 } as const,
      { kind: 'vertical', at_m: 1, turn_deg: 30 } as const,
    ]) {
      const { u, v, normal } = planeOf(axes, section);
      cross(u, v).forEach((value, k) => expect(value).toBeCloseTo(normal[k]!));
      if (section.kind === 'vertical') expect(v).toEqual(axes.up);
      else expect(normal).toEqual(axes.up);
    }
  });
});

describe('axesOf', () => {
  it('is at right angles, whatever the wish', () => {
    for (const wish of [
      [1, 1, 0],
      [0, 1, 0],
      [0, 0, 0],
    ] as const) {
      const { along, up } = axesOf([0, 1, 0], wish);
      expect(dot(along, up)).toBeCloseTo(0);
      expect(Math.hypot(...along)).toBeCloseTo(1);
    }
  });
});

describe('a link', () => {
  it('opens the same view', () => {
    const state = play(
      ...begun,
      { kind: 'clip', on: true },
      { kind: 'cut', by: 'vertical' },
      { kind: 'turned', turn_deg: -30 },
    );
    expect(readCut(cutQuery(state))).toEqual({
      ...state,
      active: false,
      model: null,
      axes: { along: [1, 0, 0], up: [0, -1, 0] },
    });
    expect(cutQuery(play(...begun))).toBe('');
  });

  it('that is broken opens the whole scan', () => {
    for (const query of [
      '',
      'axes=1,0,0,1,0,0&clip=0,0,0,1,1,1',
      'axes=1,0,0,0,1&cut=horizontal,1,0',
      'axes=1,0,0,0,1,0&clip=2,0,0,1,1,1&cut=slanted,1,2',
      'axes=1,0,0,0,1,0&clip=NaN,0,0,1,1,1&cut=vertical,,0',
      'axes=1,0,0,0,1,0&cut=vertical,1e99,0',
    ])
      expect(readCut(query)).toMatchObject({ clip: null, section: null });
  });
});
