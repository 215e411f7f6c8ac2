// Sends a recording by tus 1.0.0 (https://tus.io/protocols/resumable-upload), and goes on where it was after a broken link, a restart of
// the server or a reload of the page: which upload belongs to which file is noted in localStorage, how much of it arrived the server knows.
import { t } from '../texts/texts';
import { ApiError, isRecord, refusalOf, textOf } from './api';
import { backoffDelay_ms } from './backoff';

const keyPrefix = 'hermite.upload.';
const uploadsPath = 'api/v1/uploads';
const piece_bytes = 16 * 1024 * 1024; // what a proxy that collects bodies may lose at a time
const maxFailures = 40; // in a row without a byte that arrived: about ten minutes
// The server holds a request back while an older one for the same upload ends.
const busyStatuses: readonly number[] = [408, 423, 425, 429, 502, 503, 504];

// One request. `onSent` is told how many bytes of the body are gone. Rejects with Interrupted when the link broke.
export interface Answer {
  readonly status: number;
  readonly body: string;
  header(name: string): string | null;
}
export type Send = (
  method: string,
  path: string,
  headers: Record<string, string>,
  body: Blob | null,
  onSent: (bytes: number) => void,
) => Promise<Answer>;

export interface UploadWorld {
  readonly send: Send;
  readonly storage: Pick<Storage, 'getItem' | 'setItem' | 'removeItem' | 'key' | 'length'>;
  wait(ms: number): Promise<void>;
  random(): number;
  now_ms(): number;
}

export type RecordingFile = Pick<File, 'name' | 'size' | 'lastModified' | 'slice'>;

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
export function fingerprint(file: RecordingFile): string {
  return `${keyPrefix}${file.size}.${file.lastModified}.${file.name}`;
}

// Fingerprints of what this page sends: two that send one upload would take it from each other.
const underWay = new Set<string>();

// Names of files that were not sent to their end and that the server still waits for. Forgets those that it does not.
export function unfinishedUploads({ storage, now_ms }: Pick<UploadWorld, 'storage' | 'now_ms'>): string[] {
  const keys = Array.from({ length: storage.length }, (_, i) => storage.key(i) ?? '').filter((key) => key.startsWith(keyPrefix));
  return keys.flatMap((key) => {
    const noted = notedUpload(storage, key);
    if (underWay.has(key)) return [];
    if (noted && noted.expires_ms > now_ms()) return [noted.name];
    storage.removeItem(key);
    return [];
  });
}

// Resolves when all of the file is on the server's disk. Rejects with an ApiError: in the server's words when it refuses, or when it was
// not there for too long; the next call with the same file goes on then.
export async function sendRecording(
  file: RecordingFile,
  token: string,
  world: UploadWorld,
  onProgress: (progress: Progress) => void,
): Promise<void> {
  const key = fingerprint(file);
  if (underWay.has(key)) throw new ApiError(t.isBeingSentAlready(file.name), false);
  underWay.add(key);
  try {
    await sendToTheEnd(new Upload(file, token, world, onProgress), file.name, world);
  } finally {
    underWay.delete(key);
  }
}

async function sendToTheEnd(upload: Upload, name: string, world: UploadWorld): Promise<void> {
  for (let failures = 0; ; ) {
    try {
      const before = upload.offset;
      if (await upload.step()) return;
      if (upload.offset > before) failures = 0;
    } catch (error) {
      if (!(error instanceof Interrupted)) throw error;
      if (++failures > maxFailures)
        throw new ApiError(t.theServerWasNotThereFor(name), false);
      upload.interrupted();
      await world.wait(backoffDelay_ms(failures, world.random()));
    }
  }
}

// Not now, but perhaps later: what Send rejects with when the link broke.
export class Interrupted extends Error {}

class Upload {
  offset = 0; // bytes on the server's disk, as far as we know
  private id: string | null; // of the upload, once there is one
  private known = false; // is `offset` what the server says?
  private readonly key: string;
  private readonly headers: Record<string, string>;

  constructor(
    private readonly file: RecordingFile,
    token: string,
    private readonly world: UploadWorld,
    private readonly onProgress: (progress: Progress) => void,
  ) {
    this.key = fingerprint(file);
    this.id = notedUpload(world.storage, this.key)?.id ?? null;
    this.headers = { Authorization: `Bearer ${token}`, 'Tus-Resumable': '1.0.0' };
  }

  interrupted(): void {
    this.known = false; // what was on its way may have arrived
    this.onProgress({ share: this.share(this.offset), waiting: true });
  }

  // One request and what follows from it; true when everything has arrived.
  async step(): Promise<boolean> {
    if (this.id === null) return await this.create();
    const path = `${uploadsPath}/${encodeURIComponent(this.id)}`;
    return this.known ? await this.sendPiece(path) : await this.ask(path, this.id);
  }

  private async create(): Promise<boolean> {
    const answer = await this.request('POST', uploadsPath, {
      'Upload-Length': String(this.file.size),
      'Upload-Metadata': `filename ${base64Of(this.file.name)}`,
    });
    if (answer.status !== 201) throw refused(answer);
    this.id = (answer.header('Location') ?? '').split('/').pop() || null;
    return this.arrived(answer);
  }

  private async ask(path: string, id: string): Promise<boolean> {
    const answer = await this.request('HEAD', path);
    if (answer.status === 200) return this.arrived(answer);
    if (answer.status !== 404 && answer.status !== 410) throw refused(answer);
    // Gone, or done with: a job has the id of its upload.
    const job = await this.request('GET', `api/v1/jobs/${encodeURIComponent(id)}`);
    this.world.storage.removeItem(this.key);
    this.id = null;
    this.offset = 0;
    return job.status === 200;
  }

  private async sendPiece(path: string): Promise<boolean> {
    const from = this.offset;
    const piece = this.file.slice(from, Math.min(this.file.size, from + piece_bytes));
    const headers = { 'Upload-Offset': String(from), 'Content-Type': 'application/offset+octet-stream' };
    const onSent = (bytes: number): void => this.onProgress({ share: this.share(from + bytes), waiting: false });
    const answer = await this.request('PATCH', path, headers, piece, onSent);
    if ([404, 409, 410].includes(answer.status)) throw new Interrupted(); // the server knows better: it is asked
    if (answer.status !== 204) throw refused(answer);
    return this.arrived(answer);
  }

  private arrived(answer: Answer): boolean {
    const said = answer.header('Upload-Offset') ?? '';
    const offset = /^\d+$/.test(said) ? Number(said) : NaN;
    if (this.id === null || !(offset <= this.file.size)) throw new ApiError(t.theServersAnswerCannotBeRead, false);
    [this.offset, this.known] = [offset, true];
    this.onProgress({ share: this.share(offset), waiting: false });
    if (offset < this.file.size) this.note(this.id, answer);
    else this.world.storage.removeItem(this.key);
    return offset === this.file.size;
  }

  private share(bytes: number): number {
    return this.file.size > 0 ? bytes / this.file.size : 1;
  }

  private note(id: string, answer: Answer): void {
    const expires_ms = Date.parse(answer.header('Upload-Expires') ?? '');
    if (Number.isNaN(expires_ms)) return;
    try {
      this.world.storage.setItem(this.key, JSON.stringify({ id, name: this.file.name, expires_ms }));
    } catch {
      // Storage is full or forbidden: a broken link is survived all the same, a reload is not.
    }
  }

  private async request(
    method: string,
    path: string,
    more: Record<string, string> = {},
    body: Blob | null = null,
    onSent = (_bytes: number): void => {},
  ): Promise<Answer> {
    const answer = await this.world.send(method, path, { ...this.headers, ...more }, body, onSent);
    if (busyStatuses.includes(answer.status)) throw new Interrupted();
    return answer;
  }
}

function refused(answer: Answer): ApiError {
  if (answer.status === 401) return new ApiError(t.theServerDoesNotAcceptThis, true);
  return new ApiError(refusalOf(answer.body, answer.status), false);
}

function notedUpload(storage: UploadWorld['storage'], key: string): Noted | null {
  try {
    const json: unknown = JSON.parse(storage.getItem(key) ?? 'null');
    if (!isRecord(json) || !textOf(json['id']) || typeof json['expires_ms'] !== 'number') return null;
    return { id: textOf(json['id']), name: textOf(json['name']), expires_ms: json['expires_ms'] };
  } catch {
    return null;
  }
}

function base64Of(text: string): string {
  return btoa(Array.from(new TextEncoder().encode(text), (byte) => String.fromCharCode(byte)).join(''));
}

const stall_ms = 60_000; // without a byte going out or an answer

// Not with fetch, which tells no progress of what is sent.
const sendByXhr: Send = (method, path, headers, body, onSent) =>
  new Promise((resolve, reject) => {
    const sending = new XMLHttpRequest();
    let stalled: ReturnType<typeof setTimeout> | undefined;
    const moved = (): void => {
      clearTimeout(stalled);
      stalled = setTimeout(() => sending.abort(), stall_ms);
    };
    sending.open(method, path);
    for (const [name, value] of Object.entries(headers)) sending.setRequestHeader(name, value);
    sending.upload.onprogress = (event) => {
      moved();
      onSent(event.loaded);
    };
    const header = (name: string): string | null => sending.getResponseHeader(name);
    sending.onload = () => resolve({ status: sending.status, body: sending.responseText, header });
    sending.onerror = sending.onabort = () => reject(new Interrupted());
    sending.onloadend = () => clearTimeout(stalled);
    moved();
    sending.send(body);
  });

export function browserWorld(): UploadWorld {
  return {
    send: sendByXhr,
    storage: localStorage,
    wait: (ms) => new Promise((resolve) => setTimeout(resolve, ms)),
    random: Math.random,
    now_ms: Date.now,
  };
}
