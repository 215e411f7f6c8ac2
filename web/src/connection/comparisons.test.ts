import { describe, expect, it } from 'vitest';
import { ApiError } from './api';
import { parseComparison } from './comparisons';

const region = {
  kind: 'moved_away',
  area_m2: 0.04,
  mean_distance_m: -0.021,
  sigma_m: 0.001,
  low_m: [0, 0, 0],
  high_m: [1, 1, 1],
};
const report = {
  verdict: 'same_place',
  agreeing_share: 0.98,
  overlap: 0.9,
  weakest_sigma_m: 0.0004,
  least_change_m: 0.01,
  compared_area_m2: 12.5,
  unseen_area_m2: 1,
  parts_of_b: 3,
  path_of_a_is_known: true,
  path_of_b_is_known: false,
  regions: [region],
};

describe('a comparison', () => {
  it('is read with its report when it is ready', () => {
    const { state, report: read } = parseComparison({
      with: 'b',
      state: 'ready',
      done: 1,
      words: '',
      report,
    });
    expect(state).toBe('ready');
    expect(read).toMatchObject({
      verdict: 'same_place',
      weakestSigma_m: 0.0004,
      comparedArea_m2: 12.5,
      partCounts: [1, 3],
      pathsKnown: [true, false],
    });
    expect(read!.regions).toEqual([
      {
        kind: 'moved_away',
        area_m2: 0.04,
        distance_m: -0.021,
        sigma_m: 0.001,
        low_m: [0, 0, 0],
        high_m: [1, 1, 1],
      },
    ]);
  });
  it('has no report before that', () => {
    expect(parseComparison({ state: 'running', done: 7, words: '' })).toEqual({
      state: 'running',
      done: 1,
      words: '',
      report: null,
    });
  });
  it('of other places has no regions', () => {
    expect(
      parseComparison({ state: 'ready', report: { verdict: 'mirrored', words: 'x' } }).report,
    ).toMatchObject({
      verdict: 'mirrored',
      weakestSigma_m: null,
      regions: [],
    });
  });
  it('that cannot be read is said so', () => {
    for (const broken of [
      null,
      {},
      { state: 'ready' },
      { state: 'ready', report: { verdict: 'perhaps' } },
      { state: 'ready', report: { ...report, regions: [{ ...region, low_m: [0, 'x', 0] }] } },
    ])
      expect(() => parseComparison(broken)).toThrow(ApiError);
  });
});
