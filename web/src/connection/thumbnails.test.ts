import { afterEach, describe, expect, it, vi } from 'vitest';
import type { ScanSummary } from './api';
import { Thumbnails } from './thumbnails';

afterEach(() => vi.unstubAllGlobals());

const scanOf = (
  id: string,
  phase: ScanSummary['phase'] = 'finished',
  frameCount = 7,
): ScanSummary => ({
  id,
  title: id,
  tags: [],
  phase,
  words: '',
  frameCount,
  droppedCount: 0,
  imported: false,
  started: null,
  ended: null,
});

function serve(answer: (path: string) => Response): string[] {
  const asked: string[] = [];
  vi.stubGlobal('fetch', async (path: string) => {
    asked.push(path);
    return answer(path);
  });
  vi.stubGlobal('createImageBitmap', async (blob: Blob) => {
    const text = await blob.text();
    if (text === 'damaged') throw new DOMException('no image');
    return { text };
  });
  return asked;
}

describe('Thumbnails', () => {
  it('fetches the drawing of a scan that has ended once', async () => {
    const asked = serve(() => new Response('drawing'));
    const thumbnails = new Thumbnails();
    const scan = scanOf('a');
    expect(thumbnails.known(scan)).toBeUndefined();
    expect(thumbnails.isStale(scan, 0)).toBe(true);
    const [one, other] = await Promise.all([
      thumbnails.fetch(scan, 'token', 0),
      thumbnails.fetch(scan, 'token', 0),
    ]);
    expect(one).toEqual({ text: 'drawing' });
    expect(other).toBe(one);
    expect(asked).toEqual(['api/v1/scans/a/thumbnail.jpg']);
    expect(thumbnails.known(scan)).toBe(one);
    expect(thumbnails.isStale(scan, 1e9)).toBe(false);
  });

  it('remembers a missing and a damaged image, but not that the server was away', async () => {
    serve((path) => {
      if (path.includes('/gone/')) return new Response('', { status: 404 });
      if (path.includes('/old/')) return new Response(null, { status: 204 });
      if (path.includes('/damaged/')) return new Response('damaged');
      throw new TypeError('no network');
    });
    const thumbnails = new Thumbnails();
    expect(await thumbnails.fetch(scanOf('gone'), 'token', 0)).toBeNull();
    expect(await thumbnails.fetch(scanOf('old'), 'token', 0)).toBeNull();
    expect(await thumbnails.fetch(scanOf('damaged'), 'token', 0)).toBeNull();
    await expect(thumbnails.fetch(scanOf('far'), 'token', 0)).rejects.toThrow();
    expect(thumbnails.isStale(scanOf('gone'), 1e9)).toBe(false);
    expect(thumbnails.isStale(scanOf('far'), 1)).toBe(true);
  });

  it('shows what a running scan’s camera sees every five seconds, then its model', async () => {
    let onDisk = true;
    const asked = serve((path) => {
      if (path.endsWith('thumbnail.jpg')) return new Response('drawing');
      return onDisk ? new Response('image') : new Response(null, { status: 204 });
    });
    const thumbnails = new Thumbnails();
    const running = scanOf('a', 'running');
    expect(await thumbnails.fetch(running, 'token', 1000)).toEqual({ text: 'image' });
    expect(asked).toEqual(['api/v1/scans/a/frames/color/6']);
    expect(thumbnails.isStale(running, 3000)).toBe(false);
    expect(thumbnails.isStale(running, 6000)).toBe(true);
    onDisk = false;
    expect(await thumbnails.fetch(running, 'token', 6000)).toEqual({ text: 'image' });
    const ended = scanOf('a');
    expect(thumbnails.isStale(ended, 6001)).toBe(true);
    expect(await thumbnails.fetch(ended, 'token', 6001)).toEqual({ text: 'drawing' });
  });

  it('asks for no image of a scan that has no frames yet', async () => {
    const asked = serve(() => new Response('image'));
    expect(await new Thumbnails().fetch(scanOf('a', 'running', 0), 'token', 0)).toBeNull();
    expect(asked).toEqual([]);
  });

  it('keeps a few hundred', async () => {
    serve(() => new Response('drawing'));
    const thumbnails = new Thumbnails();
    for (let i = 0; i < 301; ++i) await thumbnails.fetch(scanOf(`scan${i}`), 'token', i);
    expect(thumbnails.known(scanOf('scan0'))).toBeUndefined();
    expect(thumbnails.known(scanOf('scan1'))).toBeDefined();
  });
});
