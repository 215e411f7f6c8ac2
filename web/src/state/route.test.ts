import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { compareHash, frameHash, frameOf, hashOf, qualityHash, routeOf } from './route';

describe('routeOf', () => {
  it('finds back every scan that hashOf names', () => {
    fc.assert(
      fc.property(fc.string({ minLength: 1, unit: 'grapheme' }), (scanId) => {
        expect(routeOf(hashOf(scanId))).toEqual({ page: 'scan', scanId, view: '' });
        expect(routeOf(hashOf(scanId, 'clip=1,2'))).toEqual({
          page: 'scan',
          scanId,
          view: 'clip=1,2',
        });
      }),
    );
  });

  it('knows the page of the quality, also with other fields, and a frame', () => {
    expect(routeOf(qualityHash('a/b'))).toMatchObject({ page: 'quality', scanId: 'a/b' });
    expect(routeOf('#/scan/a?clip=1&page=quality')).toMatchObject({ page: 'quality', scanId: 'a' });
    expect(routeOf(frameHash('a', 17))).toEqual({ page: 'scan', scanId: 'a', view: 'frame=17' });
    expect(frameOf('frame=17')).toBe(17);
    for (const none of ['', 'frame=', 'frame=-1', 'frame=x', 'frame=1e3', 'frame=12345678901'])
      expect(frameOf(none)).toBeNull();
  });

  it('knows a comparison, with the id of the other scan', () => {
    expect(routeOf(compareHash('a/b', 'c&d'))).toEqual({
      page: 'compare',
      scanId: 'a/b',
      other: 'c&d',
    });
    expect(routeOf('#/scan/a?page=compare')).toMatchObject({ page: 'scan' });
  });

  it('shows the list for everything else', () => {
    for (const hash of ['', '#', '#/', '#/scan/', '#/scan/a/b', '#/scan/%E0%A4%A', '#/other'])
      expect(routeOf(hash)).toEqual({ page: 'list' });
  });
});
