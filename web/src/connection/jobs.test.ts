import { describe, expect, it } from 'vitest';
import { ApiError } from './api';
import { jobText } from '../state/text';
import { parseJobs } from './jobs';

describe('parseJobs', () => {
  it('keeps the order of the server and what it says', () => {
    const jobs = parseJobs({
      jobs: [
        {
          id: 'b',
          title: 'Hall',
          state: 'running',
          stage: 'tracking',
          done: 3,
          total: 10,
          words: '',
          scan: 's',
        },
        { id: 'a', title: '', state: 'failed', words: 'cut short', scan: null },
      ],
    });
    expect(jobs[0]).toEqual({
      id: 'b',
      title: 'Hall',
      state: 'running',
      stage: 'tracking',
      done: 3,
      total: 10,
      words: '',
      scanId: 's',
    });
    expect(jobs[1]).toMatchObject({
      id: 'a',
      title: 'Untitled recording',
      state: 'failed',
      words: 'cut short',
      scanId: null,
    });
  });

  it('survives rows with fields that are missing or of the wrong kind', () => {
    const jobs = parseJobs({
      jobs: [{ id: 'a', state: 7, done: 'all', total: NaN }, null, { title: 'no id' }],
    });
    expect(jobs).toHaveLength(1);
    expect(jobs[0]).toMatchObject({ state: 'unknown', done: 0, total: 0 });
  });

  it('says so when the answer is no list', () => {
    for (const answer of [null, [], {}, { jobs: 3 }])
      expect(() => parseJobs(answer)).toThrow(ApiError);
  });
});

describe('jobText', () => {
  it('says how far a running job is', () => {
    expect(jobText({ state: 'running', stage: 'tracking', done: 3, total: 1000 }).text).toBe(
      'Tracking 3 of 1,000',
    );
    expect(jobText({ state: 'running', stage: '', done: 0, total: 0 }).text).toBe('Starting');
    expect(jobText({ state: 'failed', stage: '', done: 0, total: 0 })).toEqual({
      text: 'Failed',
      tone: 'bad',
    });
  });
});
