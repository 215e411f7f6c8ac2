import { expect, it } from 'vitest';
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

it('writes metres and millimetres with as many digits as it is told', () => {
  expect([1.2, -0.1, -0.0001, 1234.5].map((length_m) => metresText(length_m, 3))).toEqual([
    '1.200 m',
    '−0.100 m',
    '0.000 m',
    '1,234.500 m',
  ]);
  expect(metresText(3.98, 1)).toBe('4.0 m');
  expect([millimetresText(0.0234, 1), millimetresText(0.05, 0)]).toEqual(['23.4 mm', '50 mm']);
});

it('writes a length that was chosen with the digits that it has', () => {
  expect([0.0005, 0.005, 0.01, 0.07, 0.125, 1, 2.5, 200].map(lengthText)).toEqual([
    '0.5 mm',
    '5 mm',
    '1 cm',
    '7 cm',
    '12.5 cm',
    '1 m',
    '2.5 m',
    '200 m',
  ]);
  expect([0, 22.5, -90, 0.1 + 0.2].map(exactNumber)).toEqual(['0', '22.5', '-90', '0.3']);
});

it('rounds estimates and bounds up', () => {
  expect(
    [0, 0.0021, 0.003, 0.0091, 0.0123, Math.fround(0.05), 0.99, 0.991, 1.26, 1.31].map(
      roundedUpText,
    ),
  ).toEqual(['1 mm', '3 mm', '3 mm', '1 cm', '2 cm', '5 cm', '99 cm', '1.0 m', '1.3 m', '1.4 m']);
  expect([0.004, 0.0111, 0.7].map(withinText)).toEqual(['± 8 mm', '± 3 cm', '± 1.4 m']);
});

it('writes how long something took or takes', () => {
  expect([0.01, 0.8, 9.97, 75, 3700].map(durationText)).toEqual([
    'less than 0.1 s',
    '0.8 s',
    '10 s',
    '1 min 15 s',
    '1 h 1 min',
  ]);
  expect([0.9, 1, 9.4, 75].map(secondsText)).toEqual([
    'less than a second',
    '1 s',
    '9 s',
    '1 min 15 s',
  ]);
  expect(millisecondsText(33.3)).toBe('33 ms');
});

it('writes times as a clock does, and as a camera does', () => {
  expect([0, 59.96, 62.34].map((at_s) => clockText(at_s))).toEqual(['0:00.0', '1:00.0', '1:02.3']);
  expect([0, 59.96, 62.34].map((at_s) => clockText(at_s, 0))).toEqual(['0:00', '0:59', '1:02']);
  expect([0, 62.0334, 754.0335].map((at_s) => clockText(at_s, 3))).toEqual([
    '0:00.000',
    '1:02.033',
    '12:34.034',
  ]);
  expect([1.5, 1700000000.125].map(timestampText)).toEqual(['1.5 s', '1700000000.125 s']);
});
