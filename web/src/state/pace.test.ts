import { describe, expect, it } from 'vitest';
import { PaceMeter, paceText } from './pace';

describe('PaceMeter', () => {
  it('counts by the numbers of frames, of which not all are told', () => {
    const meter = new PaceMeter();
    for (const [sequence, at_ms] of [
      [10, 0],
      [25, 500],
      [25, 700],
      [40, 1000],
    ] as const)
      meter.frame(sequence, at_ms);
    expect(meter.perSecond(1000)).toBeCloseTo(30);
  });

  it('says nothing of too short a time, and of frames that are long ago', () => {
    const meter = new PaceMeter();
    expect(meter.perSecond(0)).toBeNull();
    meter.frame(0, 0);
    meter.frame(15, 500);
    expect(meter.perSecond(500)).toBeNull();
    meter.frame(30, 1000);
    expect(meter.perSecond(1000)).toBeCloseTo(30);
    expect(meter.perSecond(7000)).toBeNull();
  });

  it('follows a camera that gets slower', () => {
    const meter = new PaceMeter();
    for (let second = 0; second <= 10; ++second) meter.frame(30 * second, 1000 * second);
    for (let second = 1; second <= 6; ++second) meter.frame(300 + second, 10_000 + 1000 * second);
    expect(meter.perSecond(16_000)).toBeCloseTo(1);
  });

  it('begins anew with a connection, and with frames that are processed again', () => {
    const meter = new PaceMeter();
    const count = (from: number): void => {
      meter.frame(from, 100);
      meter.frame(from + 20, 1100);
    };
    count(100);
    meter.frame(null, 1150);
    expect(meter.perSecond(1150)).toBeNull();
    count(200);
    meter.frame(3, 1200);
    expect(meter.perSecond(1200)).toBeNull();
  });
});

describe('paceText', () => {
  const started = new Date('2026-05-01T12:00:00Z');
  const after = (elapsed_s: number): Date => new Date(started.getTime() + 1000 * elapsed_s);
  const running = { phase: 'running', paused: false, started } as const;

  it('says how long and how fast', () => {
    expect(paceText(running, 29.94, after(42.9))).toBe('0:42 · 29.9 fps');
    expect(paceText(running, 4, after(3723))).toBe('62:03 · 4.0 fps');
  });

  it('says what of it is known', () => {
    expect(paceText(running, null, after(5))).toBe('0:05');
    expect(paceText({ ...running, paused: true }, 30, after(5))).toBe('0:05');
    expect(paceText({ ...running, started: null }, 30, after(5))).toBe('30.0 fps');
    expect(paceText({ ...running, phase: 'finished' }, 30, after(5))).toBe('');
  });

  it('does not believe a clock that is wrong', () => {
    expect(paceText(running, null, after(-5))).toBe('0:00');
    expect(paceText(running, 30, after(-3600))).toBe('30.0 fps');
    expect(paceText(running, 30, after(50 * 365 * 86_400))).toBe('30.0 fps');
  });
});
