import { describe, expect, it } from 'vitest';
import { BehindMeter, behindParts, behindText, silenceText } from './behind';

const delays = { frameAge_ms: 300, points_ms: 700, surface_ms: 900 };

describe('BehindMeter', () => {
  it('adds the times of the server, of half the shortest round trip and of the browser', () => {
    const meter = new BehindMeter();
    meter.modelDrawn(40);
    meter.imageDrawn(delays, { asked_ms: 1000, answered_ms: 1020 }, 1025, true);
    // This answer took longer, perhaps because the server was busy: the way is not longer for that.
    const behind = meter.imageDrawn(delays, { asked_ms: 2000, answered_ms: 2100 }, 2130, true);
    expect(behind).toEqual({
      image_ms: 300 + 10 + 30,
      model_ms: 900 + 10 + 40,
      server_ms: 900,
      way_ms: 10,
    });
    expect(
      meter.imageDrawn(delays, { asked_ms: 3000, answered_ms: 3100 }, 3130, false).model_ms,
    ).toBe(700 + 10 + 40);
  });
  it('does not let one change that waited for a hidden page count', () => {
    const meter = new BehindMeter();
    for (const took_ms of [50, 60_000, 40]) meter.modelDrawn(took_ms);
    expect(meter.imageDrawn(delays, { asked_ms: 0, answered_ms: 0 }, 0, true).model_ms).toBe(950);
  });
  it('says nothing about what it does not know', () => {
    const unknown = { frameAge_ms: null, points_ms: null, surface_ms: null };
    const behind = new BehindMeter().imageDrawn(
      unknown,
      { asked_ms: 0, answered_ms: 10 },
      10,
      true,
    );
    expect(behind).toEqual({ image_ms: null, model_ms: null, server_ms: null, way_ms: 5 });
    expect(behindText(behind)).toBe('');
  });
  it('is the same whatever the clock of the browser says', () => {
    const at = (offset_ms: number): unknown => {
      const meter = new BehindMeter();
      meter.modelDrawn(40);
      return meter.imageDrawn(
        delays,
        { asked_ms: offset_ms, answered_ms: offset_ms + 20 },
        offset_ms + 25,
        true,
      );
    };
    expect(at(1e9)).toEqual(at(0));
  });
});

describe('what is said of it', () => {
  const behind = { image_ms: 412, model_ms: 12_345, server_ms: 11_900, way_ms: 10 };
  it('is short', () => {
    expect(behindText(behind)).toBe('Delay: model 12 s, images 0.4 s');
    expect(behindText({ ...behind, model_ms: null })).toBe('Delay: images 0.4 s');
  });
  it('names the parts, and what is in none of them', () => {
    expect(behindParts(behind)).toContain(
      'the server takes 12 s; the way and this browser take 0.4 s',
    );
    expect(behindParts(behind)).toContain('The way from the camera to the server is not in it');
  });
  it('is that no frame comes, when it is so', () => {
    expect(silenceText(2999)).toBe('');
    expect(silenceText(5000)).toBe('No new frame for 5 s');
  });
});
