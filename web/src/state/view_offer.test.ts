import { describe, expect, it } from 'vitest';
import { initialLiveScan, type LiveScan } from './live_scan';
import { viewOffer } from './view_offer';
import { initialViewOptions } from './view_options';

const empty = initialLiveScan('a');
const running: LiveScan = { ...empty, phase: 'running', framesReceived: 5, points: 100 };
const growing: LiveScan = { ...running, triangles: 10, surfaceHasConfidences: true };
const ended: LiveScan = { ...running, phase: 'finished' };
const covered = { ...initialViewOptions, coverage: true };
const onPoints = { ...initialViewOptions, show: 'points' } as const;

describe('the panel of the view', () => {
  it('offers the looks of points until there is a surface, then the colours of that', () => {
    expect(viewOffer(initialViewOptions, running, null)).toMatchObject({
      show: true,
      surface: false,
      points: true,
      pointLooks: true,
    });
    expect(viewOffer(initialViewOptions, growing, null)).toMatchObject({
      show: true,
      surface: true,
      points: false,
      pointLooks: false,
    });
    expect(viewOffer(onPoints, growing, null)).toMatchObject({
      show: true,
      surface: false,
      points: true,
      pointLooks: true,
    });
  });
  it('has no choice where there are only points for ever', () => {
    expect(viewOffer(initialViewOptions, ended, null).show).toBe(false);
    expect(viewOffer(initialViewOptions, ended, false).show).toBe(true);
  });
  it('offers no colours with coverage, and no surface where that has no confidences', () => {
    expect(viewOffer(covered, growing, null)).toMatchObject({
      show: true,
      surface: false,
      points: false,
      pointLooks: false,
    });
    const plain = { ...growing, surfaceHasConfidences: false };
    expect(viewOffer(covered, plain, null)).toMatchObject({ show: false, pointLooks: true });
    // The finished surface has none.
    expect(viewOffer(covered, ended, true)).toMatchObject({ show: false, pointLooks: true });
  });
  it('shows a surface with images in their colours', () => {
    expect(viewOffer(initialViewOptions, ended, true).meshColor).toBe('rgb');
    expect(viewOffer(initialViewOptions, ended, false).meshColor).toBe('shaded');
  });
  it('offers to follow a camera that leads, and coverage where one has seen something', () => {
    expect(viewOffer(initialViewOptions, running, null)).toMatchObject({
      follow: true,
      coverage: true,
      coverageInMenu: false,
    });
    expect(viewOffer(initialViewOptions, ended, null)).toMatchObject({
      follow: false,
      coverage: true,
      coverageInMenu: true,
    });
    expect(viewOffer(covered, ended, null).coverageInMenu).toBe(false);
    expect(viewOffer(initialViewOptions, { ...ended, framesReceived: 0 }, null).coverage).toBe(
      false,
    );
  });
});
