import type { HttpRequest, HttpResponse, HttpStack } from 'tus-js-client';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { sendingText, unfinishedText } from '../state/text';
import { ApiError } from './api';
import {
  fingerprint,
  sendRecording,
  unfinishedUploads,
  withStallLimit,
  type Progress,
  type UploadWorld,
} from './upload';
import { PageStorage } from '../state/storages';

const hour_ms = 3_600_000;
const now_ms = Date.parse('2026-05-01T12:00:00Z');

function fileOf(size: number, name = 'kitchen.tar', lastModified = 7): File {
  const bytes = Uint8Array.from({ length: size }, (_, i) => (i * 31 + (i >> 10)) & 0xff);
  return new File([bytes], name, { lastModified });
}

type Send = (
  method: string,
  path: string,
  headers: Record<string, string>,
  body: Blob | null,
  onSent: (bytes: number) => void,
) => Promise<HttpResponse>;

class LinkBroke extends Error {}

// Requests that `send` answers.
function httpOf(send: Send, onAbort = (): void => {}): HttpStack {
  return {
    getName: () => 'test',
    createRequest(method, url): HttpRequest {
      const headers: Record<string, string> = {};
      let onSent = (_bytes: number): void => {};
      return {
        getMethod: () => method,
        getURL: () => url,
        setHeader: (name, value) => void (headers[name] = value),
        getHeader: (name) => headers[name],
        setProgressHandler: (handler) => void (onSent = handler),
        send: (body: Blob | null) => send(method, url, headers, body, onSent),
        abort: async () => onAbort(),
        getUnderlyingObject: () => null,
      };
    },
  };
}

// What tus 1.0.0 asks of a server, and faults by number of request: `keep` so many bytes of the
// piece that it cuts, or `status` alone.
class Server {
  readonly uploads = new Map<string, { length: number; bytes: Uint8Array; metadata: string }>();
  readonly jobs = new Set<string>();
  readonly asked: string[] = [];
  readonly faults = new Map<
    number,
    { keep?: number; status?: number; loseAnswer?: boolean; body?: string }
  >();

  readonly send: Send = async (method, path, headers, body, onSent) => {
    const number = this.asked.push(`${method} ${headers['Upload-Offset'] ?? ''}`.trim());
    const fault = this.faults.get(number);
    if (fault?.status) return answer(fault.status, {}, fault.body);
    expect(headers['Authorization']).toBe('Bearer secret');
    const id = path.split('/').pop()!;
    if (path.startsWith('api/v1/jobs/')) return answer(this.jobs.has(id) ? 200 : 404);
    expect(headers['Tus-Resumable']).toBe('1.0.0');
    if (method === 'POST') {
      const made = `u${this.uploads.size + 1}`;
      this.uploads.set(made, {
        length: Number(headers['Upload-Length']),
        bytes: new Uint8Array(),
        metadata: headers['Upload-Metadata'] ?? '',
      });
      return this.state(201, made, { Location: `/somewhere/api/v1/uploads/${made}` });
    }
    const upload = this.uploads.get(id);
    if (!upload) return answer(404);
    if (method === 'HEAD') return this.state(200, id);
    if (Number(headers['Upload-Offset']) !== upload.bytes.length) return answer(409);
    const piece = new Uint8Array(await body!.arrayBuffer()).slice(0, fault?.keep);
    upload.bytes = Uint8Array.from([...upload.bytes, ...piece]);
    onSent(piece.length);
    if (fault?.keep !== undefined || fault?.loseAnswer) throw new LinkBroke();
    return this.state(204, id);
  };

  private state(status: number, id: string, more: Record<string, string> = {}): HttpResponse {
    const { bytes, length } = this.uploads.get(id)!;
    const expires =
      bytes.length < length ? { 'Upload-Expires': new Date(now_ms + hour_ms).toUTCString() } : {};
    return answer(status, {
      'Upload-Offset': String(bytes.length),
      'Upload-Length': String(length),
      ...expires,
      ...more,
    } as Record<string, string>);
  }
}

function answer(status: number, headers: Record<string, string> = {}, body = ''): HttpResponse {
  return {
    getStatus: () => status,
    getBody: () => body,
    getHeader: (name) => headers[name],
    getUnderlyingObject: () => null,
  };
}

async function bytesOf(file: File): Promise<Uint8Array> {
  return new Uint8Array(await file.arrayBuffer());
}

describe('sendRecording', () => {
  let server: Server;
  let world: UploadWorld;
  let waits_ms: number[];
  let progress: Progress[];
  let whenWaited: (goOn: () => void) => void; // at the end of a wait before another try
  const send = (file: File): Promise<void> =>
    sendRecording(file, 'secret', world, (step) => progress.push(step));

  beforeEach(() => {
    server = new Server();
    waits_ms = [];
    progress = [];
    whenWaited = (goOn) => goOn();
    world = {
      http: httpOf(server.send),
      storage: new PageStorage(),
      random: () => 0.99,
      now_ms: () => now_ms,
    };
    const soon = (goOn: () => void, wait_ms = 0): unknown => {
      waits_ms.push(wait_ms);
      return setImmediate(() => whenWaited(goOn));
    };
    vi.spyOn(globalThis, 'setTimeout').mockImplementation(soon as typeof setTimeout);
  });
  afterEach(() => vi.restoreAllMocks());

  it('sends a file and forgets it when all of it has arrived', async () => {
    const file = fileOf(5000, 'Küche.tar');
    await send(file);
    expect(server.uploads.get('u1')!.bytes).toEqual(await bytesOf(file));
    expect(server.uploads.get('u1')!.metadata).toBe(
      `filename ${Buffer.from('Küche.tar').toString('base64')}`,
    );
    expect(server.asked).toEqual(['POST', 'PATCH 0']);
    expect(progress.at(-1)).toEqual({ share: 1, waiting: false });
    expect(world.storage.length).toBe(0);
  });

  it('asks after a broken link how much has arrived, and goes on there', async () => {
    const file = fileOf(5000);
    server.faults.set(2, { keep: 1234 }).set(3, { status: 502 });
    await send(file);
    expect(server.asked).toEqual(['POST', 'PATCH 0', 'HEAD', 'HEAD', 'PATCH 1234']);
    expect(server.uploads.get('u1')!.bytes).toEqual(await bytesOf(file));
    expect(waits_ms).toEqual([495, 990]);
    expect(progress.some((step) => step.waiting)).toBe(true);
  });

  it('goes on after a reload when the same file is added again', async () => {
    const file = fileOf(5000);
    server.faults.set(2, { keep: 3000 });
    const load = (): Promise<typeof import('./upload')> => {
      vi.resetModules();
      return import('./upload');
    };
    const closed = await load();
    await new Promise<void>((waits) => {
      whenWaited = () => waits();
      void closed.sendRecording(file, 'secret', world, () => {});
    });
    whenWaited = (goOn) => goOn();
    const reloaded = await load();
    expect(reloaded.unfinishedUploads(world)).toEqual(['kitchen.tar']);
    await reloaded.sendRecording(fileOf(5000), 'secret', world, () => {});
    expect(server.asked).toEqual(['POST', 'PATCH 0', 'HEAD', 'PATCH 3000']);
    expect(server.uploads.get('u1')!.bytes).toEqual(await bytesOf(file));
    expect(reloaded.unfinishedUploads(world)).toEqual([]);
  });

  it('sends a file once at a time, and does not call it unfinished meanwhile', async () => {
    let first = Promise.resolve();
    server.faults.set(2, { keep: 100 });
    const go = await new Promise<() => void>((held) => {
      whenWaited = held;
      first = send(fileOf(5000));
    });
    expect(world.storage.length).toBe(1);
    expect(unfinishedUploads(world)).toEqual([]);
    await expect(send(fileOf(5000))).rejects.toThrow('kitchen.tar is being sent already.');
    go();
    await first;
    expect(server.uploads.size).toBe(1);
  });

  it('does not take another file for the same', () => {
    const same = fingerprint(fileOf(10));
    expect(fingerprint(fileOf(10))).toBe(same);
    for (const other of [fileOf(11), fileOf(10, 'hall.tar'), fileOf(10, 'kitchen.tar', 8)])
      expect(fingerprint(other)).not.toBe(same);
  });

  it('begins again when the server has let the upload go', async () => {
    const file = fileOf(5000);
    world.storage.setItem(
      fingerprint(file),
      JSON.stringify({ id: 'gone', name: file.name, expires_ms: now_ms + hour_ms }),
    );
    await send(file);
    expect(server.asked).toEqual(['HEAD', 'GET', 'POST', 'PATCH 0']);
    expect(server.uploads.size).toBe(1);
  });

  it('knows that it is done when the last answer was lost and the job has begun', async () => {
    server.faults.set(2, { loseAnswer: true });
    whenWaited = (goOn) => {
      server.uploads.delete('u1');
      server.jobs.add('u1');
      goOn();
    };
    await send(fileOf(5000));
    expect(server.asked).toEqual(['POST', 'PATCH 0', 'HEAD', 'GET']);
    expect(server.uploads.size).toBe(0);
  });

  it('sends a large file in pieces', async () => {
    const file = new File([new Uint8Array(17 * 1024 * 1024)], 'large.tar');
    const pieces: number[] = [];
    world = {
      ...world,
      http: httpOf(async (method, _path, _headers, body) => {
        if (body) pieces.push(body.size);
        const offset = pieces.reduce((sum, size) => sum + size, 0);
        const headers: Record<string, string> = {
          'Upload-Offset': String(offset),
          Location: '/api/v1/uploads/u1',
        };
        return answer(method === 'POST' ? 201 : 204, headers);
      }),
    };
    await send(file);
    expect(pieces).toEqual([16 * 1024 * 1024, 1024 * 1024]);
  });

  it('says what the server says when it refuses, at once', async () => {
    server.faults.set(1, {
      status: 413,
      body: '{"error": {"message": "an upload may have 5 GB"}}',
    });
    await expect(send(fileOf(10))).rejects.toThrow('The server says: an upload may have 5 GB.');
    server.faults.set(2, { status: 401 });
    await expect(send(fileOf(10))).rejects.toMatchObject({ unauthorized: true });
    expect(waits_ms).toEqual([]);
  });

  it('gives up after a long time without the server, and can go on later', async () => {
    const file = fileOf(5000);
    server.faults.set(2, { keep: 100 });
    for (let request = 3; request < 60; ++request) server.faults.set(request, { status: 503 });
    await expect(send(file)).rejects.toThrow('Add kitchen.tar again and it goes on');
    expect(waits_ms).toHaveLength(40);
    expect(Math.max(...waits_ms)).toBeLessThanOrEqual(30_000);
    server.faults.clear();
    await send(file);
    expect(server.uploads.get('u1')!.bytes).toEqual(await bytesOf(file));
  });

  it('does not run in circles with a server that contradicts itself', async () => {
    for (let request = 2; request < 200; request += 2) server.faults.set(request, { status: 409 });
    await expect(send(fileOf(10))).rejects.toThrow('too long');
    expect(server.asked.length).toBeLessThan(90);
  });

  it('does not believe nonsense', async () => {
    for (const offset of ['', '-1', '11', '1e1', 'x', '99999999999999999999']) {
      world = {
        ...world,
        http: httpOf(async () => answer(201, { Location: '/u/u1', 'Upload-Offset': offset })),
      };
      await expect(send(fileOf(10))).rejects.toThrow(ApiError);
    }
  });

  it('survives a storage that is full, forbidden or full of nonsense', async () => {
    const file = fileOf(5000);
    world.storage.setItem(fingerprint(file), '{"id": 3');
    world = {
      ...world,
      storage: Object.assign(world.storage, {
        setItem: () => {
          throw new Error('QuotaExceededError');
        },
      }),
    };
    server.faults.set(2, { keep: 1000 });
    await send(file);
    expect(server.uploads.get('u1')!.bytes).toEqual(await bytesOf(file));
  });
});

describe('withStallLimit', () => {
  afterEach(() => void vi.useRealTimers());

  it('gives a request up when nothing moves for a minute, and no earlier', async () => {
    vi.useFakeTimers();
    let moved = (_bytes: number): void => {};
    let aborted = false;
    const silent: Send = (_method, _path, _headers, _body, onSent) => {
      moved = onSent;
      return new Promise(() => {});
    };
    const stalled = withStallLimit(httpOf(silent, () => (aborted = true))).createRequest(
      'PATCH',
      'api/v1/uploads/u1',
    );
    stalled.setProgressHandler(() => {});
    const refused = expect(stalled.send(null)).rejects.toThrow();
    await vi.advanceTimersByTimeAsync(50_000);
    moved(1);
    await vi.advanceTimersByTimeAsync(50_000);
    expect(aborted).toBe(false);
    await vi.advanceTimersByTimeAsync(10_000);
    await refused;
    expect(aborted).toBe(true);
  });
});

describe('unfinishedUploads', () => {
  it('forgets what the server does not keep any more, and leaves what is not ours', () => {
    const storage = new PageStorage();
    const note = (key: string, expires_ms: number): void =>
      storage.setItem(key, JSON.stringify({ id: 'u', name: `${key}.tar`, expires_ms }));
    note('hermite.upload.old', now_ms - 1);
    note('hermite.upload.new', now_ms + 1);
    storage.setItem('hermite.upload.bad', '[');
    storage.setItem('theme', 'dark');
    expect(unfinishedUploads({ storage, now_ms: () => now_ms })).toEqual([
      'hermite.upload.new.tar',
    ]);
    expect(storage.length).toBe(2);
  });
});

describe('texts about sending', () => {
  it('say how far it is, and what to do', () => {
    expect(sendingText('a.tar', { share: 0.439, waiting: false })).toBe('Sending a.tar: 43 %');
    expect(sendingText('a.tar', { share: 0.5, waiting: true })).toBe(
      'Sending a.tar: 50 %, waiting for the server',
    );
    expect(unfinishedText([])).toBe('');
    expect(unfinishedText(['a.tar'])).toBe(
      'a.tar was not sent to the end. Add it again and it goes on from there.',
    );
    expect(unfinishedText(['a', 'b'])).toBe(
      'a, b were not sent to the end. Add them again and they go on from there.',
    );
  });
});
