// Lengths and times as a person reads them, in the language of the page. Files for programs and
// numbers in forms have their own ways.
import { decimal, locale, t } from '../texts/texts';

// With the digits that it has, for what was chosen or recorded.
export function exactNumber(value: number): string {
  return value.toLocaleString(locale, { maximumFractionDigits: 6, useGrouping: false });
}

// "−0.100 m"
export function metresText(length_m: number, digits: number): string {
  const isNegative = Number(length_m.toFixed(digits)) < 0; // what rounds to nothing has no sign
  return `${isNegative ? '−' : ''}${decimal(Math.abs(length_m), digits)} m`;
}

export function millimetresText(length_m: number, digits: number): string {
  return `${decimal(1000 * length_m, digits)} mm`;
}

// Of a length that was chosen: "5 mm", "12.5 cm", "2 m".
export function lengthText(length_m: number): string {
  if (length_m < 0.01) return `${exactNumber(1000 * length_m)} mm`;
  return length_m < 1 ? `${exactNumber(100 * length_m)} cm` : `${exactNumber(length_m)} m`;
}

// Of an estimate or a bound, which is never told smaller than it is: rounded up to a millimetre, a
// centimetre or a tenth of a metre.
export function roundedUpText(length_m: number): string {
  // A micrometre may come from rounding.
  const up_mm = Math.max(1, Math.ceil(1000 * length_m - 1e-3));
  if (up_mm < 10) return `${up_mm} mm`;
  return up_mm <= 990
    ? `${Math.ceil(up_mm / 10)} cm`
    : `${decimal(Math.ceil(up_mm / 100) / 10, 1)} m`;
}

// Twice a standard deviation.
export function withinText(sigma_m: number): string {
  return `± ${roundedUpText(2 * sigma_m)}`;
}

// Of something that is over.
export function durationText(duration_s: number): string {
  if (duration_s < 0.05) return t.lessThan(`${decimal(0.1, 1)} s`);
  return duration_s < 9.95 ? `${decimal(duration_s, 1)} s` : wholeText(duration_s);
}

// Of something that goes on, whose tenths would flicker.
export function secondsText(duration_s: number): string {
  return duration_s < 1 ? t.lessThanASecond : wholeText(duration_s);
}

function wholeText(duration_s: number): string {
  const whole_s = Math.round(duration_s);
  if (whole_s < 60) return `${whole_s} s`;
  const [hours, minutes, seconds] = [
    Math.floor(whole_s / 3600),
    Math.floor(whole_s / 60) % 60,
    whole_s % 60,
  ];
  return hours > 0 ? `${hours} h ${minutes} min` : `${minutes} min ${seconds} s`;
}

export function millisecondsText(duration_ms: number): string {
  return `${decimal(duration_ms, 0)} ms`;
}

// "1:02.3"; whole seconds are those that are over, as on a clock.
export function clockText(at_s: number, digits: 0 | 1 | 3 = 1): string {
  const steps = digits === 0 ? Math.floor(at_s) : Math.round(10 ** digits * at_s);
  const perMinute = 60 * 10 ** digits;
  const seconds = decimal((steps % perMinute) / 10 ** digits, digits);
  return `${Math.floor(steps / perMinute)}:${seconds.padStart(digits === 0 ? 2 : 3 + digits, '0')}`;
}

// By the camera's clock, which may count from 1970.
export function timestampText(at_s: number): string {
  return `${exactNumber(at_s)} s`;
}
