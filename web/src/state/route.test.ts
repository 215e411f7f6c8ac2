import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { hashOf, routeOf } from './route';

describe('routeOf', () => {
  it('finds back every scan that hashOf names', () => {
    fc.assert(
      fc.property(fc.string({ minLength: 1, unit: 'grapheme' }), (scanId) => {
        expect(routeOf(hashOf(scanId))).toEqual({ page: 'scan', scanId, view: '' });
        expect(routeOf(hashOf(scanId, 'clip=1,2'))).toEqual({ page: 'scan', scanId, view: 'clip=1,2' });
      }),
    );
  });

  it('shows the list for everything else', () => {
    for (const hash of ['', '#', '#/', '#/scan/', '#/scan/a/b', '#/scan/%E0%A4%A', '#/other']) expect(routeOf(hash)).toEqual({ page: 'list' });
  });
});
