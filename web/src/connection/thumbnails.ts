// The small images of scans, for the list: of one that has ended the server's drawing of its model,
// of a running one what its camera sees.
import { ApiError, request, scanPath, type ScanSummary } from './api';
import { fetchLiveColor } from './frames';

const limit_ms = 10_000;
const live_ms = 5_000; // between two images of a running scan
const mostKept = 300; // of some 30 kB

// null: the server has none, as of scans from before it drew any.
type Thumbnail = ImageBitmap | null;

interface Kept {
  readonly image: Thumbnail;
  readonly final: boolean; // it changes by edits alone
  readonly asked_ms: number;
}

export class Thumbnails {
  private readonly kept = new Map<string, Kept>(); // the one that was asked for last is last
  private readonly waiting = new Map<string, Promise<Thumbnail>>();

  // What is known of it without asking; undefined: nothing.
  known(scan: ScanSummary): Thumbnail | undefined {
    return this.kept.get(scan.id)?.image;
  }

  // Whether asking for it may tell more than is known.
  isStale(scan: ScanSummary, now_ms: number): boolean {
    const kept = this.kept.get(scan.id);
    if (!kept) return true;
    return !kept.final && (scan.phase !== 'running' || now_ms - kept.asked_ms >= live_ms);
  }

  // Rejects with an ApiError when it could not be had this time. Asked twice at
  // once it is fetched once.
  fetch(scan: ScanSummary, token: string, now_ms: number): Promise<Thumbnail> {
    const asked = this.waiting.get(scan.id);
    if (asked !== undefined) return asked;
    const before = this.kept.get(scan.id);
    const fetching = (
      scan.phase === 'running' ? liveImage(scan, token) : drawing(scan, token)
    ).then((image) => {
      // A frame that is not on the server's disk yet leaves the one before.
      const shown = image ?? (scan.phase === 'running' ? (before?.image ?? null) : null);
      this.keep(scan.id, { image: shown, final: scan.phase !== 'running', asked_ms: now_ms });
      return shown;
    });
    const done = fetching.finally(() => this.waiting.delete(scan.id));
    this.waiting.set(scan.id, done);
    return done;
  }

  // The model has changed.
  forget(id: string): void {
    this.kept.delete(id);
  }

  private keep(id: string, kept: Kept): void {
    this.kept.delete(id);
    this.kept.set(id, kept);
    for (const oldest of this.kept.keys()) {
      if (this.kept.size <= mostKept) break;
      this.kept.delete(oldest);
    }
  }
}

// They outlive the page of the list, which people leave and come back to.
export const thumbnails = new Thumbnails();

async function drawing(scan: ScanSummary, token: string): Promise<Thumbnail> {
  try {
    const response = await request(`${scanPath(scan.id)}/thumbnail.jpg`, token, { limit_ms });
    return response.status === 204 ? null : await decoded(await response.blob());
  } catch (error) {
    if (error instanceof ApiError && error.missing) return null;
    throw error;
  }
}

async function liveImage(scan: ScanSummary, token: string): Promise<Thumbnail> {
  if (scan.frameCount === 0) return null;
  const color = await fetchLiveColor(
    scan.id,
    token,
    scan.frameCount - 1,
    AbortSignal.timeout(limit_ms),
  );
  return color && decoded(color.image);
}

// A damaged image is none.
async function decoded(blob: Blob): Promise<Thumbnail> {
  return createImageBitmap(blob, { resizeWidth: 480, resizeQuality: 'medium' }).catch(() => null);
}
