import { expect, it } from 'vitest';
import { ServerClock } from './server_clock';

const answer = (date: string): Headers => new Headers({ Date: date, 'Cache-Control': 'no-store' });
const noon_ms = Date.parse('2026-05-01T12:00:00Z');

it('is the clock of the server, however wrong the one of this computer is', () => {
  const clock = new ServerClock();
  const hourBehind_ms = noon_ms - 3_600_000;
  clock.hear(answer('Fri, 01 May 2026 12:00:00 GMT'), hourBehind_ms);
  expect(clock.now(hourBehind_ms + 2000).getTime() - noon_ms).toBe(2500);
});

it('is the clock of this computer until an answer says more', () => {
  const clock = new ServerClock();
  clock.hear(new Headers(), noon_ms);
  clock.hear(new Headers({ Date: 'Fri, 01 May 2020 12:00:00 GMT' }), noon_ms);
  clock.hear(answer('yesterday'), noon_ms);
  expect(clock.now(noon_ms)).toEqual(new Date(noon_ms));
});
