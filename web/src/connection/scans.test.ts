import { afterEach, expect, test, vi } from 'vitest';
import { labelScan, parseAccess, parseReport } from './scans';

afterEach(() => vi.unstubAllGlobals());

test('what a token may do is read', () => {
  expect(parseAccess({ scopes: ['view', 'scan', 'admin'], scan: null, embedding: true })).toEqual({
    view: true,
    scan: true,
    admin: true,
    shared: false,
    embedding: true,
  });
  expect(parseAccess({ scopes: ['view'], scan: 'abc' })).toEqual({
    view: true,
    scan: false,
    admin: false,
    shared: true,
    embedding: false,
  });
  expect(parseAccess({ scopes: ['scan', 'fly'] })).toEqual({
    view: false,
    scan: true,
    admin: false,
    shared: false,
    embedding: false,
  });
  for (const wrong of [null, 'x', {}, { scopes: 'view' }])
    expect(() => parseAccess(wrong)).toThrow();
});

test('what a report says is read, and an older one or an import says nothing', () => {
  const whole = {
    surfels: 9,
    cloud_points: 7,
    frames: 5,
    tracked_frames: 4,
    weak_frames: 1,
    position_sigma_m: 0.01,
    calibration_doubt: 'odd',
    mapping: { parts: 2, loops: 'many' },
    device: 'a GPU',
  };
  expect(parseReport(whole)).toMatchObject({
    surfels: 9,
    cloudPoints: 7,
    frames: 5,
    trackedFrames: 4,
    weakFrames: 1,
    positionSigma_m: 0.01,
    calibrationDoubt: 'odd',
    mapping: { parts: 2 },
    device: 'a GPU',
  });
  const nothing = parseReport({});
  expect(nothing).toMatchObject({
    surfels: null,
    cloudPoints: null,
    trackedFrames: null,
    calibrationDoubt: '',
    mapping: {},
    meanFrame_ms: null,
  });
  for (const odd of [null, 'x', { surfels: 'many', mapping: 3 }])
    expect(parseReport(odd)).toEqual(nothing);
});

test('which way is up is read from a report, or nothing', () => {
  const up = (value: unknown) => parseReport({ up: value }).up;
  expect(up({ in_world: [0, -0.8, -0.6], sigma_deg: 180 })).toEqual({
    inWorld: [0, -0.8, -0.6],
    sigma_rad: Math.PI,
  });
  for (const odd of [
    undefined,
    null,
    3,
    [],
    { in_world: [0, -1, 0] },
    { in_world: [0, -1], sigma_deg: 1 },
    { in_world: [0, -1, '0'], sigma_deg: 1 },
    { in_world: [0, -2, 0], sigma_deg: 1 },
    { in_world: [0, 0, -1, 0], sigma_deg: 1 },
  ])
    expect(up(odd)).toBeNull();
});

test('tags are sent alone, and those that the server has kept come back', async () => {
  const fetch = vi.fn((_path: string, _asked: RequestInit) =>
    Promise.resolve(new Response(JSON.stringify({ id: 'a/b', tags: ['attic', 'house 9'] }))),
  );
  vi.stubGlobal('fetch', fetch);
  const { tags } = await labelScan('a/b', { tags: ['house 9', 'attic'] }, 'secret');
  expect(tags).toEqual(['attic', 'house 9']);
  const [path, asked] = fetch.mock.calls[0]!;
  expect([path, asked.method, asked.body]).toEqual([
    'api/v1/scans/a%2Fb',
    'PATCH',
    '{"tags":["house 9","attic"]}',
  ]);
});
