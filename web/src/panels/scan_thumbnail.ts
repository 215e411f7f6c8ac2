// The small image beside a scan in the list. It is fetched when it comes into view.
import type { ScanSummary } from '../connection/api';
import type { Thumbnails } from '../connection/thumbnails';
import { element } from './dom';

const [width_px, height_px] = [480, 360]; // as the server draws them

export interface ThumbnailViews {
  make(scan: ScanSummary): HTMLElement;
  clear(): void; // those that were made are not looked at any more
}

export function thumbnailViews(thumbnails: Thumbnails, token: () => string): ThumbnailViews {
  const scans = new Map<Element, ScanSummary>();
  const draw = (canvas: HTMLCanvasElement, image: ImageBitmap): void => {
    // What has another shape is cut, not bent.
    const scale = Math.max(width_px / image.width, height_px / image.height);
    const [w, h] = [image.width * scale, image.height * scale];
    canvas.getContext('2d')!.drawImage(image, (width_px - w) / 2, (height_px - h) / 2, w, h);
    canvas.classList.add('there');
  };
  const load = (canvas: HTMLCanvasElement, scan: ScanSummary): void => {
    thumbnails.fetch(scan, token(), performance.now()).then(
      (image) => {
        if (image) draw(canvas, image);
      },
      () => {}, // the list says what is wrong with the server, and asks again
    );
  };
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      const scan = scans.get(entry.target);
      if (!entry.isIntersecting || !scan) continue;
      seen.unobserve(entry.target);
      load(entry.target as HTMLCanvasElement, scan);
    }
  });
  return {
    make(scan) {
      const canvas = element('canvas', {
        class: 'thumbnail',
        width: width_px,
        height: height_px,
        'aria-hidden': 'true',
      });
      const known = thumbnails.known(scan);
      if (known) draw(canvas, known);
      if (thumbnails.isStale(scan, performance.now())) {
        scans.set(canvas, scan);
        seen.observe(canvas);
      }
      return canvas;
    },
    clear() {
      seen.disconnect();
      scans.clear();
    },
  };
}
