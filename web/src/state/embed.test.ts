import { describe, expect, it } from 'vitest';
import { readFragment } from '../connection/token';
import { elementHtml, embeddedLink, frameHtml, isEmbedded, wholeLink } from './embed';
import { routeOf } from './route';

const link =
  'https://scans.example/hermite/#share=hms_abc&scan=0123456789abcdefghijklmnop&clip=1,2';

describe('an embedded scan', () => {
  it('is told by its address, however else it is looked at', () => {
    const route = routeOf(readFragment(new URL(embeddedLink(link)).hash).hash);
    expect(route).toMatchObject({
      page: 'scan',
      scanId: '0123456789abcdefghijklmnop',
      view: 'clip=1,2&embed=1',
    });
    expect(route.page === 'scan' && isEmbedded(route.view)).toBe(true);
    expect(isEmbedded('clip=1,2')).toBe(false);
    expect(isEmbedded('embed=10')).toBe(false);
    expect(wholeLink(embeddedLink(link))).toBe(link);
  });

  it('is a frame whose title cannot end it', () => {
    const html = frameHtml(link, '"><script>alert(1)</script>');
    expect(html).toContain(
      'src="https://scans.example/hermite/#share=hms_abc&amp;scan=0123456789abcdefghijklmnop&amp;clip=1,2&amp;embed=1"',
    );
    expect(html).toContain('title="&quot;&gt;&lt;script&gt;alert(1)&lt;/script&gt;"');
    expect(html.match(/<\w+/g)).toEqual(['<iframe']);
  });

  it('is an element of the viewer’s own', () => {
    const html = elementHtml(link, 'a & b', 'https://scans.example/hermite/');
    expect(html).toContain(
      '<script src="https://scans.example/hermite/hermite-viewer.js" defer></script>',
    );
    expect(html).toContain('title="a &amp; b"');
  });
});
