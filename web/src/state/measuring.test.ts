import { expect, test } from 'vitest';
import type { KeptMeasurement, Measured } from '../connection/measurements';
import {
  canClose,
  freeName,
  hasNewest,
  initialMeasuring,
  measuringText,
  reduceMeasuring,
  type Measuring,
  type MeasuringEvent,
} from './measuring';

const measured: Measured = {
  kind: 'distance',
  points: [
    [0, 0, 1],
    [0, 0, 2],
  ],
  normals: [],
  words: '1.000 m ± 0.002 m (95 %)',
};
const kept: KeptMeasurement = { ...measured, id: 'a', name: 'Distance 1' };
const after = (...events: MeasuringEvent[]): Measuring =>
  events.reduce(reduceMeasuring, initialMeasuring);
const begun = { kind: 'active', active: true } as const;
const click = { kind: 'chosen', place: [0, 0, 1] } as const;
const area = { kind: 'wanted', measure: 'area' } as const;
const undo = { kind: 'undone' } as const;
const close = { kind: 'closed' } as const;

test('two clicks ask the server once, and a third waits for its answer', () => {
  expect(after(begun, click)).toMatchObject({ points: [[0, 0, 1]], busy: false });
  expect(measuringText(after(begun, click))).toContain('second');
  expect(after(begun, click, click)).toMatchObject({ busy: true });
  expect(after(begun, click, click, click)).toEqual(after(begun, click, click));
  expect(after(begun, click, click, undo)).toEqual(after(begun, click, click));
  expect(after(begun, click, click, { kind: 'measured', measured })).toMatchObject({
    busy: false,
    points: [],
    newest: measured,
  });
});

test('a click beside everything leaves the first point', () => {
  const state = after(begun, click, { kind: 'chosen', place: null });
  expect(state.points).toEqual([[0, 0, 1]]);
  expect(measuringText(state)).toContain('nothing');
});

test('an answer that comes after the tool was put away, or another kind chosen, is none', () => {
  expect(
    after(begun, click, click, { kind: 'active', active: false }, { kind: 'measured', measured })
      .newest,
  ).toBeNull();
  expect(after(begun, click, click, area, { kind: 'measured', measured }).newest).toBeNull();
});

test('each kind says what to click on', () => {
  const textFor = (measure: Measured['kind'], ...events: MeasuringEvent[]): string =>
    measuringText(after(begun, { kind: 'wanted', measure }, ...events));
  expect(textFor('plane')).toContain('then on a plane');
  expect(textFor('plane', click)).toBe('Now click on the plane.');
  expect(textFor('height')).toContain('higher');
  expect(textFor('angle', click)).toContain('second surface');
});

test('an outline is closed from three corners on, and corners are taken back one by one', () => {
  expect(after(begun, area, click, click)).toMatchObject({ busy: false });
  const early = after(begun, area, click, click, close);
  expect(early.busy).toBe(false);
  expect(measuringText(early)).toContain('three corners');
  const three = after(begun, area, click, click, click);
  expect(canClose(three)).toBe(true);
  expect(measuringText(three)).toMatch(/^3 corners\. .*double click/);
  expect(after(begun, area, click, click, click, undo).points).toHaveLength(2);
  expect(after(begun, area, click, click, click, close)).toMatchObject({ busy: true });
  expect(after(begun, area, close)).toEqual(after(begun, area));
  expect(after(begun, click, close)).toEqual(after(begun, click)); // a distance has no outline
  expect(after(begun, area, ...Array<MeasuringEvent>(64).fill(click))).toMatchObject({
    busy: true,
  }); // as many as the server takes
});

test('what is wrong is said of the point, and the corners of an area stay', () => {
  const state = after(begun, click, click, {
    kind: 'failed',
    message: 'The server says: points[1]: no surface was seen within 6 cm of the point.',
  });
  expect(measuringText(state)).toBe('Second point: no surface was seen within 6 cm of the point.');
  expect(state).toMatchObject({ points: [], busy: false });
  const outline = after(begun, area, click, click, click, close, {
    kind: 'failed',
    message: 'The server says: points[2]: no surface was seen.',
  });
  expect(measuringText(outline)).toBe('Corner 3: no surface was seen.');
  expect(outline).toMatchObject({ busy: false });
  expect(outline.points).toHaveLength(3);
});

test('what is kept is listed until it is removed', () => {
  const state = after(
    begun,
    click,
    click,
    { kind: 'measured', measured },
    { kind: 'kept', one: kept },
  );
  expect(state).toMatchObject({ newest: null, kept: [kept] });
  expect(freeName(state.kept, 'distance')).toBe('Distance 2');
  expect(freeName([{ ...kept, name: 'Distance 2' }], 'distance')).toBe('Distance 3');
  expect(freeName(state.kept, 'area')).toBe('Area 1');
  expect(reduceMeasuring(state, { kind: 'removed', id: 'a' }).kept).toEqual([]);
});

test('the newest is shown when it comes, and the list stays when one is removed', () => {
  const [first, second] = [kept, { ...kept, id: 'b' }];
  expect(hasNewest([], [first, second])).toBe(true);
  expect(hasNewest([first], [first, second])).toBe(true);
  expect(hasNewest([first, second], [first])).toBe(false);
  expect(hasNewest([first, second], [second])).toBe(false);
  expect(hasNewest([first], [])).toBe(false);
});
