// Sends a recording by tus 1.0.0 (https://tus.io/protocols/resumable-upload) with tus-js-client,
// and goes on where it was after a broken link, a restart of the server or a reload of the page:
// which upload belongs to which file is noted in localStorage, how much of it arrived the server
// knows. Left to itself, tus-js-client begins an upload anew when a proxy answers 502, waits
// without limit for a link that stalls, believes a Location that a proxy has made wrong, fails
// where localStorage is full, and does not know when the server forgets an upload or that a
// finished one is a job. Hence its hooks below.
import {
  DefaultHttpStack,
  DetailedError,
  Upload,
  type HttpRequest,
  type HttpResponse,
  type HttpStack,
} from 'tus-js-client';
import { t } from '../texts/texts';
import { ApiError, isRecord, refusalOf, textOf } from './api';
import { backoffDelay_ms } from './backoff';
import { ofThisBrowser } from '../state/storages';

const keyPrefix = 'hermite.upload.';
const uploadsPath = 'api/v1/uploads';
const piece_bytes = 16 * 1024 * 1024; // what a proxy that collects bodies may lose at a time
const maxFailures = 40; // in a row without a byte that arrived: about ten minutes
// The server holds a request back while an older one for the same upload ends.
const busyStatuses: readonly number[] = [408, 423, 425, 429, 502, 503, 504];

export interface UploadWorld {
  readonly http: HttpStack; // a request rejects when the link broke
  readonly storage: Pick<Storage, 'getItem' | 'setItem' | 'removeItem' | 'key' | 'length'>;
  random(): number;
  now_ms(): number;
}

export interface Progress {
  readonly share: number; // 0 to 1, of what is sent
  readonly waiting: boolean; // for the server to be there again
}

interface Noted {
  readonly id: string;
  readonly name: string;
  readonly expires_ms: number;
}

// The same file, as far as a browser lets us see.
export function fingerprint(file: File): string {
  return `${keyPrefix}${file.size}.${file.lastModified}.${file.name}`;
}

// Fingerprints of what this page sends: two that send one upload would take it from each other.
const underWay = new Set<string>();

// Names of files that were not sent to their end and that the server still waits for.
// Forgets those that it does not.
export function unfinishedUploads({
  storage,
  now_ms,
}: Pick<UploadWorld, 'storage' | 'now_ms'>): string[] {
  const keys = Array.from({ length: storage.length }, (_, i) => storage.key(i) ?? '').filter(
    (key) => key.startsWith(keyPrefix),
  );
  return keys.flatMap((key) => {
    const noted = notedUpload(storage, key);
    if (underWay.has(key)) return [];
    if (noted && noted.expires_ms > now_ms()) return [noted.name];
    storage.removeItem(key);
    return [];
  });
}

// Resolves when all of the file is on the server's disk. Rejects with an ApiError: with the
// server's message when it refuses, or when it was not there for too long; the next call with
// the same file goes on then.
export async function sendRecording(
  file: File,
  token: string,
  world: UploadWorld,
  onProgress: (progress: Progress) => void,
): Promise<void> {
  const key = fingerprint(file);
  if (underWay.has(key)) throw new ApiError(t.isBeingSentAlready(file.name), false);
  underWay.add(key);
  try {
    await new Sending(file, token, world, onProgress).untilArrived();
  } finally {
    underWay.delete(key);
  }
}

// Not now, but perhaps later.
class Interrupted extends Error {}

// All of the file had arrived before, though the answer that said so was lost.
class ArrivedBefore extends Error {}

class Sending {
  private arrived_bytes = 0; // on the server's disk, as far as we know
  private readonly key: string;
  private readonly headers: Record<string, string>;

  constructor(
    private readonly file: File,
    token: string,
    private readonly world: UploadWorld,
    private readonly onProgress: (progress: Progress) => void,
  ) {
    this.key = fingerprint(file);
    this.headers = { Authorization: `Bearer ${token}` };
  }

  untilArrived(): Promise<void> {
    const { file, key, world } = this;
    const noted = notedUpload(world.storage, key);
    return new Promise((resolve, reject) => {
      const report = (bytes: number, waiting: boolean): void =>
        this.onProgress({ share: file.size > 0 ? bytes / file.size : 1, waiting });
      const arrived = (): void => {
        world.storage.removeItem(key);
        report(file.size, false);
        resolve();
      };
      const upload = new Upload(file, {
        endpoint: uploadsPath,
        uploadUrl: noted ? uploadPath(noted.id) : null,
        httpStack: world.http,
        headers: this.headers,
        metadata: { filename: file.name },
        chunkSize: piece_bytes,
        retryDelays: Array.from({ length: maxFailures }, (_, i) =>
          backoffDelay_ms(i + 1, world.random()),
        ),
        fingerprint: () => Promise.resolve(key),
        storeFingerprintForResuming: false,
        onUploadUrlAvailable: () => (upload.url = uploadPath(idOf(upload.url))),
        onAfterResponse: (request, response) => this.judge(request, response),
        onShouldRetry: (error) => {
          if (isFinal(causeOf(error))) return false;
          report(this.arrived_bytes, true);
          return true;
        },
        onProgress: (bytes) => report(bytes, false),
        onSuccess: arrived,
        onError: (error) => {
          const cause = causeOf(error);
          if (cause instanceof ArrivedBefore) arrived();
          else
            reject(
              isFinal(cause) ? cause : new ApiError(t.theServerWasNotThereFor(file.name), false),
            );
        },
      });
      upload.start();
    });
  }

  // Throws unless the answer is one to go on with.
  private async judge(request: HttpRequest, response: HttpResponse): Promise<void> {
    const status = response.getStatus();
    const method = request.getMethod();
    if (busyStatuses.includes(status)) throw new Interrupted();
    if (method === 'HEAD' && (status === 404 || status === 410))
      return this.forget(idOf(request.getURL()));
    // The server knows better how much it has: it is asked.
    if (method === 'PATCH' && [404, 409, 410].includes(status)) throw new Interrupted();
    if (status < 200 || status > 299) throw refused(response);
    const said = response.getHeader('Upload-Offset') ?? '';
    const offset = /^\d+$/.test(said) ? Number(said) : NaN;
    const id = idOf(method === 'POST' ? response.getHeader('Location') : request.getURL());
    if (id === '' || !(offset <= this.file.size))
      throw new ApiError(t.theServersAnswerCannotBeRead, false);
    this.arrived_bytes = offset;
    if (offset < this.file.size) this.note(id, response);
  }

  // The server has let the upload go, or is done with it: a job has the id of its upload.
  private async forget(id: string): Promise<void> {
    const request = this.world.http.createRequest('GET', `api/v1/jobs/${id}`);
    for (const [name, value] of Object.entries(this.headers)) request.setHeader(name, value);
    const status = (await request.send(null)).getStatus();
    if (busyStatuses.includes(status)) throw new Interrupted();
    this.world.storage.removeItem(this.key);
    this.arrived_bytes = 0;
    if (status === 200) throw new ArrivedBefore();
  }

  private note(id: string, response: HttpResponse): void {
    const expires_ms = Date.parse(response.getHeader('Upload-Expires') ?? '');
    if (Number.isNaN(expires_ms)) return;
    try {
      this.world.storage.setItem(
        this.key,
        JSON.stringify({ id, name: this.file.name, expires_ms }),
      );
    } catch {
      // Storage is full or forbidden: a broken link is survived all the same, a reload is not.
    }
  }
}

// From where the page is, behind a proxy perhaps below a folder, of which the server knows nothing.
const uploadPath = (id: string): string => `${uploadsPath}/${id}`;

// Empty: there is none.
const idOf = (address: string | null | undefined): string =>
  /(?:^|\/)([\w-]+)$/.exec(address ?? '')?.[1] ?? '';

// What a hook has thrown, or the event of the link that broke.
const causeOf = (error: Error): unknown =>
  error instanceof DetailedError ? error.causingError : error;

const isFinal = (cause: unknown): boolean =>
  cause instanceof ApiError || cause instanceof ArrivedBefore;

function refused(response: HttpResponse): ApiError {
  if (response.getStatus() === 401) return new ApiError(t.theServerDoesNotAcceptThis, true);
  return new ApiError(refusalOf(response.getBody(), response.getStatus()), false);
}

function notedUpload(storage: UploadWorld['storage'], key: string): Noted | null {
  try {
    const json: unknown = JSON.parse(storage.getItem(key) ?? 'null');
    const id = isRecord(json) ? idOf(textOf(json['id'])) : '';
    if (!isRecord(json) || id === '' || typeof json['expires_ms'] !== 'number') return null;
    return { id, name: textOf(json['name']), expires_ms: json['expires_ms'] };
  } catch {
    return null;
  }
}

const stall_ms = 60_000; // without a byte going out or an answer

// Rejects a request whose link stalls, as if it had broken.
export function withStallLimit(http: HttpStack): HttpStack {
  return {
    getName: () => http.getName(),
    createRequest(method, url) {
      const request = http.createRequest(method, url);
      const [send, watch] = [request.send.bind(request), request.setProgressHandler.bind(request)];
      let giveUp = (): void => {};
      let stalled: ReturnType<typeof setTimeout> | undefined;
      const moved = (): void => {
        clearTimeout(stalled);
        stalled = setTimeout(() => giveUp(), stall_ms);
      };
      request.setProgressHandler = (onSent) =>
        watch((bytes) => {
          moved();
          onSent(bytes);
        });
      request.send = async (body) => {
        const stall = new Promise<never>((_, reject) => (giveUp = () => reject(new Interrupted())));
        moved();
        try {
          return await Promise.race([send(body), stall]);
        } catch (error) {
          if (error instanceof Interrupted) await request.abort();
          throw error;
        } finally {
          clearTimeout(stalled);
        }
      };
      return request;
    },
  };
}

export function browserWorld(): UploadWorld {
  return {
    http: withStallLimit(new DefaultHttpStack({})),
    storage: ofThisBrowser,
    random: Math.random,
    now_ms: Date.now,
  };
}
