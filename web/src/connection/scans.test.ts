import { expect, test } from 'vitest';
import { parseAccess, parseReport } from './scans';

test('what a token may do is read', () => {
  expect(parseAccess({ scopes: ['view', 'scan', 'admin'], scan: null })).toEqual({ view: true, scan: true, admin: true, shared: false });
  expect(parseAccess({ scopes: ['view'], scan: 'abc' })).toEqual({ view: true, scan: false, admin: false, shared: true });
  expect(parseAccess({ scopes: ['scan', 'fly'] })).toEqual({ view: false, scan: true, admin: false, shared: false });
  for (const wrong of [null, 'x', {}, { scopes: 'view' }]) expect(() => parseAccess(wrong)).toThrow();
});

test('what a report says of points is read, and an older one says nothing', () => {
  expect(parseReport({ surfels: 9, cloud_points: 7 })).toEqual({ surfels: 9, cloudPoints: 7 });
  expect(parseReport({ surfels: 9 })).toEqual({ surfels: 9, cloudPoints: null });
  for (const odd of [null, 'x', { surfels: 'many' }]) expect(parseReport(odd)).toEqual({ surfels: null, cloudPoints: null });
});
