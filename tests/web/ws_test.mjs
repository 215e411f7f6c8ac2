// A camera and viewers over npm's `ws`, the WebSocket of Node's world: another implementation
// than the server's Beast, Chromium and wsproto. Messages by protobuf-es, from the same
// scan.proto as the viewer's.
//
//   node --test tests/web/ws_test.mjs
//
// HERMITE_BUILD: where the programs are (build/release).
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { mkdtemp, rm } from 'node:fs/promises';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { crc32, deflateSync } from 'node:zlib';
import { root, startServer } from './programs.mjs';

const require = createRequire(path.join(root, 'web/package.json'));
const { WebSocket } = require('ws');
const patience_ms = 120_000;
const width = 96;
const height = 72;
const frameCount = 8;

let folder, server, vite, proto, coding, scanId;

before(async () => {
  const { createServer } = await import(require.resolve('vite'));
  vite = await createServer({
    root: path.join(root, 'web'),
    server: { middlewareMode: true, ws: false, watch: null },
    optimizeDeps: { noDiscovery: true },
  });
  proto = await vite.ssrLoadModule('/src/gen/scan_pb.ts');
  coding = await vite.ssrLoadModule('@bufbuild/protobuf');
  folder = await mkdtemp(path.join(os.tmpdir(), 'hermite-ws-'));
  server = await startServer(folder);
});

after(async () => {
  await vite?.close();
  await server?.stop();
  if (folder) await rm(folder, { recursive: true, force: true });
});

const clientMessage = (name, value) =>
  coding.toBinary(
    proto.ClientMessageSchema,
    coding.create(proto.ClientMessageSchema, { body: { case: name, value } }),
  );

// Everything that the server says, until it closes. `answer` sees every message and may send.
function talk(first, { options = {}, answer = () => {} } = {}) {
  return new Promise((resolve, reject) => {
    const socket = new WebSocket(
      `${server.origin.replace('http', 'ws')}/api/v1/ws`,
      'hermite.v1',
      options,
    );
    const said = [];
    const late = setTimeout(
      () => reject(new Error(`no end after ${patience_ms} ms: ${said.map((body) => body.case)}`)),
      patience_ms,
    );
    socket.binaryType = 'nodebuffer';
    socket.on('open', () => first(socket));
    socket.on('message', (data) => {
      const { body } = coding.fromBinary(proto.ServerMessageSchema, data);
      said.push(body);
      answer(socket, body, data.length);
    });
    socket.on('error', (error) => {
      clearTimeout(late);
      reject(error);
    });
    socket.on('close', (code) => {
      clearTimeout(late);
      resolve({ code, said, extensions: socket.extensions, protocol: socket.protocol });
    });
  });
}

// One message in several WebSocket frames.
function sendInPieces(socket, data, pieces) {
  const size = Math.ceil(data.length / pieces);
  for (let i = 0; i < pieces; ++i)
    socket.send(data.subarray(i * size, (i + 1) * size), { binary: true, fin: i === pieces - 1 });
}

function png(bitDepth, colorType, bytesPerPixel, pixel) {
  const chunk = (kind, data) => {
    const body = Buffer.concat([Buffer.from(kind), data]);
    const out = Buffer.alloc(body.length + 8);
    out.writeUInt32BE(data.length, 0);
    body.copy(out, 4);
    out.writeUInt32BE(crc32(body), body.length + 4);
    return out;
  };
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([bitDepth, colorType, 0, 0, 0], 8);
  const rows = Buffer.alloc(height * (1 + width * bytesPerPixel));
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x)
      rows.set(pixel(x, y), y * (1 + width * bytesPerPixel) + 1 + x * bytesPerPixel);
  const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  return Buffer.concat([
    signature,
    chunk('IHDR', header),
    chunk('IDAT', deflateSync(rows)),
    chunk('IEND', Buffer.alloc(0)),
  ]);
}

// The inside of a pyramid, painted as a checkerboard, before a camera that stands still.
// Each depth image has other noise, as a sensor's has: one that comes twice is taken for a
// driver that has stopped.
const depth_mm = (x, y, frame) =>
  1500 + 4 * Math.abs(x - 40) + 6 * Math.abs(y - 30) + ((x * 7 + y * 13 + frame * 5) % 3);
const depthOf = (frame) =>
  png(16, 0, 2, (x, y) => [depth_mm(x, y, frame) >> 8, depth_mm(x, y, frame) & 255]);
const color = png(8, 2, 3, (x, y) => [
  80 + 100 * ((Math.floor(x / 8) + Math.floor(y / 8)) % 2),
  2 * x,
  3 * y,
]);

const camera = (token) =>
  clientMessage('hello', {
    client: 'ws_test.mjs',
    token,
    role: {
      case: 'startScan',
      value: {
        title: 'over ws',
        camera: {
          width,
          height,
          fx: 80,
          fy: 80,
          cx: (width - 1) / 2,
          cy: (height - 1) / 2,
          depthUnitsPerMetre: 1000,
        },
        depthCodecs: [proto.DepthCodec.PNG16],
        colorCodecs: [proto.ColorCodec.PNG],
        mode: proto.Mode.BATCH,
        settings: { 'output.unstable': 'true' },
        expectedFrames: BigInt(frameCount),
      },
    },
  });
const viewer = (token, id) =>
  clientMessage('hello', {
    client: 'ws_test.mjs',
    token,
    role: { case: 'viewScan', value: { scanId: id } },
  });

test('a camera scans: messages in pieces, pings between them, compression offered', async () => {
  let sent = 0;
  let granted = 0n;
  let pongs = 0;
  const { code, said, extensions, protocol } = await talk(
    (socket) => {
      socket.on('pong', () => ++pongs);
      sendInPieces(socket, camera(server.token), 3);
      socket.ping('between');
    },
    {
      answer: (socket, body) => {
        if (body.case === 'welcome') granted = BigInt(body.value.frameCredit);
        if (body.case === 'credit' && body.value.framesGranted > granted)
          granted = body.value.framesGranted;
        for (; BigInt(sent) < granted && sent < frameCount; ++sent) {
          const frame = {
            sequence: BigInt(sent),
            timestampS: 100 + sent / 30,
            depth: depthOf(sent),
            color,
          };
          sendInPieces(socket, clientMessage('frame', frame), 1 + (sent % 4));
          if (sent + 1 === frameCount) socket.send(clientMessage('finish', {}));
        }
      },
    },
  );
  const of = (name) => said.filter((body) => body.case === name).map((body) => body.value);
  assert.equal(code, 1000);
  assert.equal(protocol, 'hermite.v1');
  assert.equal(extensions, '', 'frames are compressed already');
  assert.equal(pongs, 1);
  assert.deepEqual(of('error'), []);
  assert.deepEqual(
    of('frameResult').map((result) => Number(result.sequence)),
    [...Array(frameCount).keys()],
  );
  for (const result of of('frameResult'))
    assert.equal(result.status, proto.TrackingStatus.TRACKED, result.reason);
  const [finished] = of('finished');
  const report = JSON.parse(finished.reportJson);
  assert.equal(report.frames, frameCount);
  assert.equal(
    report.trajectory_sha256,
    createHash('sha256').update(finished.trajectoryTum).digest('hex'),
  );
  [{ scanId }] = of('welcome');
});

test('a viewer gets the finished scan and acknowledges it', async () => {
  let bytes = 0n;
  const { code, said } = await talk((socket) => socket.send(viewer(server.token, scanId)), {
    answer: (socket, _body, length) => {
      bytes += BigInt(length);
      socket.send(clientMessage('viewerAck', { bytes }));
    },
  });
  assert.equal(code, 1000);
  assert.equal(said[0].case, 'welcome');
  const order = said.map((body) => body.case);
  assert.ok(
    order.includes('chunk') && order.indexOf('chunk') < order.indexOf('snapshotEnd'),
    `${order}`,
  );
  const chunks = said.filter((body) => body.case === 'chunk').map((body) => body.value);
  for (const chunk of chunks)
    assert.equal(Buffer.from(chunk.draco.subarray(0, 5)).toString(), 'DRACO');
  assert.ok(chunks.reduce((sum, chunk) => sum + chunk.pointCount, 0) > 500);
});

for (const [what, first, code] of [
  ['a wrong token', (socket) => socket.send(viewer('wrong', 'any')), 4001],
  ['a scan that does not exist', (socket) => socket.send(viewer(server.token, 'nosuchscan')), 4004],
  [
    'a frame before the hello',
    (socket) => socket.send(clientMessage('frame', { depth: depthOf(0), color })),
    1002,
  ],
  ['bytes that are no message', (socket) => socket.send(Buffer.from([255, 255, 255])), 1007],
  ['text', (socket) => socket.send('hello'), 1003],
]) {
  test(`${what} is answered by one error and ${code}`, async () => {
    const { code: closed, said } = await talk(first);
    assert.equal(closed, code);
    assert.deepEqual(
      said.map((body) => body.case),
      ['error'],
    );
  });
}

test('a page of another site and a client without the subprotocol are refused', async () => {
  await assert.rejects(
    talk(() => {}, { options: { origin: 'http://evil.example' } }),
    /403/,
  );
  const refused = new Promise((resolve) => {
    const socket = new WebSocket(`${server.origin.replace('http', 'ws')}/api/v1/ws`);
    socket.on('error', (error) => resolve(error.message));
    socket.on('open', () => resolve('opened'));
  });
  assert.match(await refused, /Unexpected server response: 4\d\d/);
});
