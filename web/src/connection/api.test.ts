import { describe, expect, it } from 'vitest';
import {
  ApiError,
  fileNameOf,
  parseScan,
  parseScans,
  refusalOf,
  shareLinkOf,
  withOlder,
  type ScanSummary,
} from './api';
import { listedScan } from './listed_scan';

describe('parseScans', () => {
  it('lists the newest scan first', () => {
    const { scans, more } = parseScans({
      scans: [
        {
          id: 'old',
          title: 'Hall',
          state: 'finished',
          frames_processed: 10,
          created_at: '2026-05-01T12:00:00.000Z',
        },
        {
          id: 'new',
          title: '',
          state: 'running',
          frames_processed: 3,
          created_at: '2026-05-01T12:00:00.001Z',
        },
      ],
    });
    expect(scans.map((scan) => scan.id)).toEqual(['new', 'old']);
    expect(more).toBe(false);
    expect(scans[0]).toMatchObject({
      title: 'Untitled scan',
      phase: 'running',
      frameCount: 3,
      started: new Date('2026-05-01T12:00:00.001Z'),
    });
  });

  it('survives rows with fields that are missing or of the wrong kind', () => {
    const { scans, more } = parseScans({
      more: true,
      scans: [
        { id: 'a', state: 7, frames_processed: 'many', created_at: 'soon' },
        null,
        { title: 'no id' },
      ],
    });
    expect(scans).toEqual([
      {
        id: 'a',
        title: 'Untitled scan',
        tags: [],
        phase: 'unknown',
        words: '',
        frameCount: 0,
        droppedCount: 0,
        imported: false,
        started: null,
        ended: null,
      },
    ]);
    expect(more).toBe(true);
  });

  it('says so when the answer is no list', () => {
    for (const answer of [null, [], {}, { scans: 3 }])
      expect(() => parseScans(answer)).toThrow(ApiError);
  });
});

it('reads one scan as it reads those of the list, and refuses what is none', () => {
  const row = { id: 'a', title: 'Hall', state: 'finished', tags: ['attic', 7, '', 'house 9'] };
  expect(parseScan(row)).toEqual(parseScans({ scans: [row] }).scans[0]);
  expect(parseScan(row).tags).toEqual(['attic', 'house 9']);
  for (const wrong of [null, 'a', {}, { id: 7 }]) expect(() => parseScan(wrong)).toThrow(ApiError);
});

describe('withOlder', () => {
  const scan = (id: string, time_ms: number): ScanSummary => listedScan(id, new Date(time_ms));
  const ids = (scans: readonly ScanSummary[]): string[] => scans.map(({ id }) => id);

  it('keeps what slips out of the newest and leaves out what was removed from them', () => {
    const before = [scan('d', 4), scan('c', 3), scan('b', 2), scan('a', 1)];
    expect(ids(withOlder([scan('e', 5), scan('d', 4)], before))).toEqual(['e', 'd', 'c', 'b', 'a']);
    expect(ids(withOlder([scan('d', 4), scan('b', 2)], before))).toEqual(['d', 'b', 'a']);
    expect(ids(withOlder([], before))).toEqual(['d', 'c', 'b', 'a']);
  });
});

describe('shareLinkOf', () => {
  const json = { path: '/#share=hms_1&scan=s1' };

  it('begins where the page is', () => {
    expect(shareLinkOf(json, { origin: 'https://a.org', pathname: '/' })).toBe(
      'https://a.org/#share=hms_1&scan=s1',
    );
    expect(shareLinkOf(json, { origin: 'https://a.org', pathname: '/scans/index.html' })).toBe(
      'https://a.org/scans/#share=hms_1&scan=s1',
    );
  });

  it('never leads elsewhere', () => {
    for (const answer of [
      null,
      {},
      { path: 3 },
      { path: '//evil.com/#share=x' },
      { path: 'https://evil.com' },
    ])
      expect(() => shareLinkOf(answer, { origin: 'https://a.org', pathname: '/' })).toThrow(
        ApiError,
      );
  });
});

describe('fileNameOf', () => {
  it('keeps what every file system takes', () => {
    expect(fileNameOf('Café: 2nd floor / east')).toBe('Cafe_2nd_floor_east');
    expect(fileNameOf('../../etc/passwd')).toBe('etc_passwd');
    expect(fileNameOf('日本')).toBe('');
    expect(fileNameOf('a'.repeat(300))).toHaveLength(80);
  });
});

describe('refusalOf', () => {
  it('has the message of the server, else the status', () => {
    expect(refusalOf('{"error": {"message": "the disk is full"}}', 507)).toBe(
      'The server says: the disk is full.',
    );
    for (const body of ['', '<html>', '{}', 'null', '{"error": {"message": 3}}'])
      expect(refusalOf(body, 502)).toBe('The server answered with HTTP 502.');
  });
});
