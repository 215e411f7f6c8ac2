import { afterEach, describe, expect, it, vi } from 'vitest';
import { ApiError } from './api';
import {
  asItIs,
  fetchExport,
  finishedAs,
  parseExports,
  removeExport,
  requestExport,
  shownMesh,
} from './exports';

afterEach(() => vi.unstubAllGlobals());

describe('shownMesh', () => {
  it('is the one that was imported, else the small one', () => {
    const exports = parseExports({
      exports: [{ format: 'glb' }, { format: 'glb-draco' }, { format: 'imported' }],
    });
    expect(shownMesh(exports, false)?.format).toBe('imported');
    // As it came it still has what was taken out.
    expect(shownMesh(exports, true)?.format).toBe('glb-draco');
    expect(shownMesh(exports.slice(0, 2), false)?.format).toBe('glb-draco');
    expect(shownMesh([], true)).toBeUndefined();
  });
});

describe('finishedAs', () => {
  const closed = { ...asItIs, close: true };
  const exports = parseExports({
    exports: [
      { format: 'glb', of_format: 'glb', state: 'ready', bytes: 3, close: false },
      { format: 'stl', of_format: 'stl' },
      {
        format: 'glb_c',
        of_format: 'glb',
        file: 'mesh_c.glb',
        state: 'queued',
        simplify_um: 0,
        triangles: 0,
        fill_holes_mm: 0,
        close: true,
      },
    ],
  });
  it('is the export of that format and that finish', () => {
    expect(finishedAs(exports, exports[0]!, closed).format).toBe('glb_c');
    expect(finishedAs(exports, exports[0]!, asItIs)).toBe(exports[0]);
  });
  it('is missing where nobody has asked for it', () => {
    expect(finishedAs(exports, exports[1]!, closed)).toMatchObject({
      format: '',
      of_format: 'stl',
      state: 'missing',
    });
    expect(finishedAs(exports, exports[0]!, { ...closed, fill_holes_mm: 150 })).toMatchObject({
      state: 'missing',
      size_bytes: 0,
    });
  });
});

describe('parseExports', () => {
  it('reads every entry, and what it does not know as missing', () => {
    const [glb, odd] = parseExports({
      exports: [
        {
          format: 'glb',
          kind: 'mesh',
          label: 'Mesh, GLB',
          file: 'mesh.glb',
          state: 'running',
          bytes: 0,
          done: 0.25,
          words: '',
        },
        { format: 'odd', state: 'sleeping', bytes: 'many', done: 7 },
        { state: 'ready' },
        3,
      ],
    });
    expect(glb).toEqual({
      format: 'glb',
      of_format: 'glb',
      finish: asItIs,
      kind: 'mesh',
      label: 'Mesh, GLB',
      file: 'mesh.glb',
      state: 'running',
      size_bytes: 0,
      done: 0.25,
      words: '',
    });
    expect(odd).toEqual({
      format: 'odd',
      of_format: 'odd',
      finish: asItIs,
      kind: '',
      label: 'odd',
      file: 'odd',
      state: 'missing',
      size_bytes: 0,
      done: 1,
      words: '',
    });
  });
  it('does not take anything else for a list', () => {
    for (const json of [null, [], {}, { exports: 3 }])
      expect(() => parseExports(json)).toThrow(ApiError);
  });
});

describe('requestExport', () => {
  it('sends the format and gives back its state', async () => {
    const sent: [string, RequestInit][] = [];
    vi.stubGlobal('fetch', async (path: string, init: RequestInit) => {
      sent.push([path, init]);
      return new Response('{"format": "glb", "state": "queued"}', { status: 202 });
    });
    expect((await requestExport('a/b', 'glb', 't')).state).toBe('queued');
    expect(sent[0]![0]).toBe('api/v1/scans/a%2Fb/exports');
    expect(sent[0]![1].body).toBe('{"format":"glb"}');
    expect(sent[0]![1].method).toBe('POST');
    await requestExport('a', 'stl', 't', { ...asItIs, fill_holes_mm: 150 });
    expect(sent[1]![1].body).toBe(
      '{"format":"stl","simplify_um":0,"triangles":0,"fill_holes_mm":150,"close":false}',
    );
  });
  it('tells a server that is busy from one that says no', async () => {
    vi.stubGlobal('fetch', async () => new Response('', { status: 503 }));
    await expect(requestExport('a', 'glb', 't')).rejects.toMatchObject({ passing: true });
    vi.stubGlobal('fetch', async () => new Response('', { status: 403 }));
    await expect(requestExport('a', 'glb', 't')).rejects.toMatchObject({
      passing: false,
      unauthorized: true,
    });
  });
});

describe('removeExport', () => {
  it('names the export with its options', async () => {
    const asked: string[] = [];
    vi.stubGlobal('fetch', async (url: string, init: RequestInit) => {
      asked.push(`${init.method} ${url}`);
      return new Response('{}');
    });
    await removeExport('a', 'stl_s1000_c', 't');
    expect(asked).toEqual(['DELETE api/v1/scans/a/exports/stl_s1000_c']);
  });
});

describe('fetchExport', () => {
  it('tells how much has come and gives all of it', async () => {
    const body = new ReadableStream<Uint8Array>({
      start(controller) {
        controller.enqueue(new Uint8Array([1, 2, 3]));
        controller.enqueue(new Uint8Array([4]));
        controller.close();
      },
    });
    vi.stubGlobal(
      'fetch',
      async () => new Response(body, { headers: { 'Content-Type': 'model/gltf-binary' } }),
    );
    const told: number[] = [];
    const blob = await fetchExport('a', 'glb', 't', (loaded_bytes) => told.push(loaded_bytes));
    expect(told).toEqual([3, 4]);
    expect(blob.type).toBe('model/gltf-binary');
    expect([...new Uint8Array(await blob.arrayBuffer())]).toEqual([1, 2, 3, 4]);
  });
  it('says when it was cut off', async () => {
    const body = new ReadableStream<Uint8Array>({
      pull(controller) {
        controller.error(new Error('reset'));
      },
    });
    vi.stubGlobal('fetch', async () => new Response(body));
    await expect(fetchExport('a', 'glb', 't', () => {})).rejects.toThrow(
      'The download was cut off.',
    );
  });
});
