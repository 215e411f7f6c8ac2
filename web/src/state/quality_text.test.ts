import { describe, expect, it } from 'vitest';
import { parseRange, type FrameList, type FrameStatus } from '../connection/frames';
import { parseReport } from '../connection/scans';
import { pathOf } from './camera_path';
import { frameShares, mapFacts } from './quality_facts';
import { doubtText, followedOf, imageText, percentText, qualityText } from './quality_text';

const reportOf = (frames: number, tracked: number, weak = 0, more: Record<string, unknown> = {}) =>
  parseReport({ frames, tracked_frames: tracked, weak_frames: weak, ...more });
const listOf = (...runs: (readonly [FrameStatus, number])[]): FrameList => {
  const statuses = runs.flatMap(([status, frames]) => new Array<FrameStatus>(frames).fill(status));
  return {
    timestamps_s: statuses.map((_, i) => i / 10),
    statuses,
    reasons: statuses.map(() => ''),
  };
};

describe('qualityText', () => {
  it('says that all is well, and no more', () => {
    expect(qualityText(followedOf(reportOf(512, 512), null))).toBe(
      'The camera was followed in all of 512 frames.',
    );
    expect(qualityText(followedOf(reportOf(1, 1), null))).toBe(
      'The camera was followed in the only frame.',
    );
    expect(qualityText(followedOf(reportOf(1, 1, 1), null))).toBe(
      'The camera was followed in the only frame; it is doubtful.',
    );
  });

  it('says how large an error of the path is expected, rounded up', () => {
    const textOf = (path_m: unknown, tracked = 9): string =>
      qualityText(followedOf(reportOf(9, tracked, 0, { expected_error: { path_m } }), null));
    expect(textOf(0.0021)).toBe(
      'The camera was followed in all of 9 frames. Its path should be right to about 3 mm, calibration aside.',
    );
    expect(
      [0.0001, 0.003, 0.0123, 0.099, 1.26].map(
        (path_m) => /about (.*), calibration aside\.$/.exec(textOf(path_m))![1],
      ),
    ).toEqual(['1 mm', '3 mm', '2 cm', '10 cm', '1.3 m']);
    expect(textOf('3')).toBe('The camera was followed in all of 9 frames.');
    expect(textOf(0.002, 0)).toBe('The camera could not be followed in any of 9 frames.');
  });

  it('says that frames arrived incompletely', () => {
    const textOf = (torn_frames: number): string =>
      qualityText(followedOf(reportOf(9, 9, 0, { torn_frames }), null));
    expect(textOf(0)).toBe('The camera was followed in all of 9 frames.');
    expect(textOf(1)).toContain('One frame arrived incompletely, and only a part of it was used.');
    expect(textOf(3)).toContain('3 frames arrived incompletely, and only a part of each was used');
  });

  it('names doubtful and lost stretches with their time, or else their number', () => {
    const list = listOf(['tracked', 20], ['weak', 5], ['tracked', 20], ['weak', 3], ['tracked', 2]);
    expect(qualityText(followedOf(reportOf(50, 50, 8), list))).toBe(
      'The camera was followed in all of 50 frames; 8 of them are doubtful, for 0.8 s in all.',
    );
    expect(qualityText(followedOf(reportOf(50, 50, 8), null))).toBe(
      'The camera was followed in all of 50 frames; 8 of them are doubtful.',
    );
    const lost = listOf(['tracked', 30], ['lost', 10], ['weak', 1], ['tracked', 30]);
    expect(qualityText(followedOf(reportOf(71, 61, 1), lost))).toBe(
      'The camera was followed in 61 of 71 frames; one of them is doubtful, for 0.1 s. It was lost once, for 1.0 s.',
    );
    expect(qualityText(followedOf(reportOf(71, 61, 0), null))).toBe(
      'The camera was followed in 61 of 71 frames. It was lost in 10 frames.',
    );
    const end = listOf(['tracked', 30], ['lost', 10], ['tracked', 30], ['lost', 20]);
    expect(qualityText(followedOf(reportOf(90, 60), end))).toContain(
      'It was lost twice, for 3.0 s in all, and was not found again before the end.',
    );
  });

  it('says how long the camera was lost and doubtful, not how long the place is', () => {
    const runs = Array.from(
      { length: 300 },
      (_, i) =>
        [
          ['tracked', 3],
          [i === 150 ? 'lost' : 'weak', 1],
        ] as const,
    ).flat();
    const followed = followedOf(reportOf(1200, 1199, 299), listOf(...runs));
    expect(qualityText(followed)).toBe(
      'The camera was followed in 1,199 of 1,200 frames; 299 of them are doubtful, for 30 s in all. It was lost once, for 0.1 s.',
    );
    expect(followed.doubts!.map(doubtText)).toEqual([
      'Lost for 0.1 s: 1 frame not in the model; doubtful for 30 s: 299 frames nearly lost, but in the model',
    ]);
    const [twice] = followedOf(
      null,
      listOf(['tracked', 5], ['lost', 1], ['tracked', 1], ['lost', 2], ['tracked', 5]),
    ).doubts!;
    expect(doubtText(twice!)).toBe('Lost twice, for 0.3 s in all: 3 frames not in the model');
  });

  it('is honest where nothing was followed, or nobody knows', () => {
    expect(qualityText(followedOf(reportOf(24, 0), listOf(['lost', 24])))).toBe(
      'The camera could not be followed in any of 24 frames.',
    );
    expect(qualityText(followedOf(null, null))).toBe(
      'How well the camera was followed is not recorded in this scan.',
    );
    expect(qualityText(followedOf(parseReport({ surfels: 1 }), listOf(['unknown', 9])))).toBe(
      'How well the camera was followed is not recorded in this scan.',
    );
    expect(qualityText(followedOf(null, listOf(['tracked', 9], ['lost', 1])))).toContain(
      'in 9 of 10 frames',
    );
  });

  it('does not take a report that could not be loaded for one that says nothing', () => {
    const why = 'The server asks to wait a little.';
    const text = qualityText(followedOf(null, null, why));
    expect(text).toMatch(
      /^The scan’s report could not be loaded, .* parts, .* calibration fits\. /,
    );
    expect(text.endsWith(` calibration fits. ${why}`)).toBe(true);
    expect(text).not.toContain('not recorded');
    expect(qualityText(followedOf(null, listOf(['tracked', 9], ['lost', 1]), why))).toMatch(
      /in 9 of 10 frames.*could not be loaded/,
    );
  });

  it('names frames that were not used', () => {
    const text = qualityText(
      followedOf(
        reportOf(10, 10),
        listOf(['tracked', 10], ['left_out', 30], ['refused', 1], ['damaged', 2]),
      ),
    );
    expect(text).toContain('30 frames were left out, since newer ones');
    expect(text).toContain('One frame was refused: its time was not after');
    expect(text).toContain('2 frames are damaged on the server’s disk.');
  });

  it('says what is wrong with the map and the camera, but not twice', () => {
    const doubt =
      'the camera’s calibration does not fit: its focal length is too great by about 2.0 %';
    const followed = followedOf(
      reportOf(10, 10, 0, { mapping: { parts: 2 }, calibration_doubt: doubt }),
      null,
    );
    const text = qualityText(followed);
    expect(text).toContain(
      'The model is in two parts that were never joined: where they lie to each other is not known.',
    );
    expect(text).toContain(
      'The camera’s calibration does not fit: its focal length is too great by about 2.0 %.',
    );
    expect(
      qualityText(followed, `${doubt}; the map is in 2 parts that could not be joined: …`),
    ).toBe('The camera was followed in all of 10 frames.');
  });
});

describe('other texts', () => {
  it('has text for a doubt and for what an image shows', () => {
    const [doubt] = followedOf(
      null,
      listOf(['tracked', 5], ['lost', 10], ['weak', 1], ['tracked', 5]),
    ).doubts!;
    expect(doubtText(doubt!)).toBe(
      'Lost for 1.0 s: 10 frames not in the model; doubtful for 0.1 s: 1 frame nearly lost, but in the model',
    );
    const depth = (header: string | null, valid_percent: number | null) => ({
      measured: parseRange(header),
      valid_percent,
    });
    expect(imageText(depth('0-0', 0), 0.01)).toBe(
      'In this frame there is no depth, and the image is nearly black.',
    );
    expect(imageText(depth(null, 0), 0.5)).toBe('In this frame there is no depth.');
    expect(imageText(depth('412-3981', 0), 0.5)).toBe(
      'In this frame less than 1 % of the pixels have depth.',
    );
    expect(imageText(depth('412-3981', 87), 0.5)).toBe(
      'In this frame 87 % of the pixels have depth.',
    );
    expect(imageText(depth('412-3981', null), 0.5)).toBe('');
    expect(imageText(null, 0.5)).toBe('');
  });

  it('does not round to all or to nothing', () => {
    expect([0, 1, 0.5, 0.99999, 0.00001].map(percentText)).toEqual([
      '0 %',
      '100 %',
      '50.0 %',
      'more than 99.9 %',
      'less than 0.1 %',
    ]);
  });

  it('leaves out of the lists what is not known', () => {
    expect(frameShares(followedOf(parseReport({}), null))).toEqual([]);
    expect(frameShares(followedOf(reportOf(100, 75, 5), null)).map(({ value }) => value)).toEqual([
      '70.0 %, 70 frames',
      '5.0 %, 5 frames',
      '25.0 %, 25 frames',
    ]);
    const older = frameShares(followedOf(parseReport({ frames: 100, tracked_frames: 75 }), null));
    expect(older.map(({ label, value }) => `${label}: ${value}`)).toEqual([
      'Followed, doubtful ones included: 75.0 %, 75 frames',
      'Lost: 25.0 %, 25 frames',
    ]);
    expect(mapFacts(parseReport({})).filter(([, value]) => value !== null)).toEqual([]);
    const facts = new Map(
      mapFacts(
        reportOf(9, 9, 0, {
          position_sigma_m: 0.0166,
          rotation_sigma_deg: 0.48,
          mapping: { 'loops by appearance': 1, 'loops by nearness': 2 },
        }),
      ),
    );
    expect([
      facts.get('Loops closed'),
      facts.get('Position at the end'),
      facts.get('Direction at the end'),
    ]).toEqual(['3', '± 4 cm', '± 1.0°']);
  });
});

describe('pathOf', () => {
  const line = (time_s: number, x: number): string => `${time_s} ${x} 0 0 0 0 0 1`;

  it('adds up where the camera was followed, and no trembling', () => {
    const path = pathOf(
      ['# a comment', ...Array.from({ length: 11 }, (_, i) => line(i / 10, i / 10))].join('\n'),
    );
    expect(path?.length_m).toBeCloseTo(1);
    expect(path?.duration_s).toBeCloseTo(1);
    const resting = pathOf(
      Array.from({ length: 1000 }, (_, i) => line(i / 10, 0.005 * (i % 2))).join('\n'),
    );
    expect(resting?.length_m).toBe(0);
  });

  it('leaves out the way of a lost camera and leaps', () => {
    const lost = pathOf(
      [
        line(0, 0),
        line(0.1, 0.1),
        line(0.2, 0.1),
        line(0.3, 0.1),
        line(0.4, 0.4),
        line(0.5, 0.5),
      ].join('\n'),
    );
    expect(lost?.length_m).toBeCloseTo(0.2);
    expect(pathOf([line(0, 0), line(0.1, 2), line(0.2, 2.1)].join('\n'))?.length_m).toBeCloseTo(
      0.1,
    );
    expect(pathOf('')).toBeNull();
  });
});
