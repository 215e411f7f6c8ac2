import { expect, test } from 'vitest';
import { freeName, initialMeasuring, measuringWords, reduceMeasuring, type Measuring, type MeasuringEvent } from './measuring';

const measured = { from: [0, 0, 1], to: [0, 0, 2], words: '1.000 m ± 0.002 m (95 %)' } as const;
const kept = { ...measured, id: 'a', name: 'Distance 1' };
const after = (...events: MeasuringEvent[]): Measuring => events.reduce(reduceMeasuring, initialMeasuring);
const begun = { kind: 'active', active: true } as const;
const click = { kind: 'chosen', place: [0, 0, 1] } as const;

test('two clicks ask the server once, and a third waits for its answer', () => {
  expect(after(begun, click)).toMatchObject({ first: [0, 0, 1], busy: false });
  expect(measuringWords(after(begun, click))).toContain('second');
  expect(after(begun, click, click)).toMatchObject({ busy: true });
  expect(after(begun, click, click, click)).toEqual(after(begun, click, click));
  expect(after(begun, click, click, { kind: 'measured', measured })).toMatchObject({ busy: false, first: null, newest: measured });
});

test('a click beside everything leaves the first point', () => {
  const state = after(begun, click, { kind: 'chosen', place: null });
  expect(state.first).toEqual([0, 0, 1]);
  expect(measuringWords(state)).toContain('nothing');
});

test('an answer that comes after the tool was put away is none', () => {
  expect(after(begun, click, click, { kind: 'active', active: false }, { kind: 'measured', measured }).newest).toBeNull();
});

test('what is wrong is said of the point', () => {
  const state = after(begun, click, click, { kind: 'failed', words: 'The server says: to: no surface was seen within 6 cm of the point.' });
  expect(measuringWords(state)).toBe('Second point: no surface was seen within 6 cm of the point.');
  expect(state).toMatchObject({ first: null, busy: false });
});

test('what is kept is listed until it is removed', () => {
  const state = after(begun, click, click, { kind: 'measured', measured }, { kind: 'kept', one: kept });
  expect(state).toMatchObject({ newest: null, kept: [kept] });
  expect(freeName(state.kept)).toBe('Distance 2');
  expect(freeName([{ ...kept, name: 'Distance 2' }])).toBe('Distance 3');
  expect(reduceMeasuring(state, { kind: 'removed', id: 'a' }).kept).toEqual([]);
});
