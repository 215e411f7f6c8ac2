// Odd and abusive WebSocket frames by npm's ws, which shares no code with ours:
// odd_frames.mjs PORT TOKEN
// Prints a JSON object: what was sent, and the close code and the last text that it got.
import path from 'node:path';
import { createRequire } from 'node:module';
import { fileURLToPath } from 'node:url';

const here = path.dirname(fileURLToPath(import.meta.url));
const { WebSocket } = createRequire(path.join(here, '../../web/package.json'))('ws');
const [port, token] = process.argv.slice(2);

function varint(value) {
  const bytes = [];
  for (; value > 0x7f; value >>>= 7) bytes.push((value & 0x7f) | 0x80);
  return Buffer.from([...bytes, value]);
}
const bytesField = (number, data) =>
  Buffer.concat([varint((number << 3) | 2), varint(data.length), data]);
// A viewer of a scan that is not there: who is understood is told so (proto/README.md).
const hello = bytesField(
  1,
  Buffer.concat([
    bytesField(3, Buffer.from(token)),
    bytesField(5, bytesField(1, Buffer.from('a'.repeat(26)))),
  ]),
);

// A frame by hand, masked with zeros.
function frame(first, payload, masked = true) {
  const size =
    payload.length < 126 ? [payload.length] : [126, payload.length >> 8, payload.length & 255];
  return Buffer.concat([
    Buffer.from([
      first,
      size[0] | (masked ? 128 : 0),
      ...size.slice(1),
      ...(masked ? [0, 0, 0, 0] : []),
    ]),
    payload,
  ]);
}

const none = Buffer.alloc(0);
const raw =
  (...frames) =>
  (socket) =>
    frames.forEach((one) => socket._socket.write(one));
const cases = {
  'a hello': (socket) => socket.send(hello),
  'a hello in frames of a byte, with pings between them': (socket) => {
    for (let i = 0; i < hello.length; i++) {
      socket.send(hello.subarray(i, i + 1), { fin: i === hello.length - 1 });
      socket.ping('x');
    }
  },
  'a hello with 20000 empty frames in it': (socket) => {
    socket.send(hello.subarray(0, 5), { fin: false });
    for (let i = 0; i < 20000; i++) socket.send(none, { fin: false });
    socket.send(hello.subarray(5), { fin: true });
  },
  text: (socket) => socket.send('hello'),
  'compressed, which was not agreed on': raw(frame(0xc2, hello)),
  'the other reserved bits': raw(frame(0xb2, hello)),
  'a kind that there is not': raw(frame(0x83, hello)),
  'a control kind that there is not': raw(frame(0x8b, none)),
  'not masked': raw(frame(0x82, hello, false)),
  'a ping of 126 bytes': raw(frame(0x89, Buffer.alloc(126))),
  'a ping in pieces': raw(frame(0x09, none), frame(0x80, none)),
  'a continuation of nothing': raw(frame(0x80, hello)),
  'a message within a message': raw(frame(0x02, hello), frame(0x82, hello)),
  'a close of one byte': raw(frame(0x88, Buffer.from([3]))),
  'a close with 1005': raw(frame(0x88, Buffer.from([3, 237]))),
  'a close with words that are no UTF-8': raw(frame(0x88, Buffer.from([3, 232, 0xff]))),
  'a million bytes of noise': (socket) => socket._socket.write(Buffer.alloc(1000000, 0x5a)),
};

function one(send) {
  return new Promise((resolve) => {
    const socket = new WebSocket(`ws://127.0.0.1:${port}/api/v1/ws`, 'hermite.v1');
    let text = '';
    socket.on('message', (data) => (text = data.toString('latin1').replace(/[^ -~]/g, '')));
    socket.on('open', () => send(socket));
    socket.on('error', (error) => (text ||= error.message));
    socket.on('close', (code) => resolve({ code, words: text }));
  });
}

const answers = {};
for (const [name, send] of Object.entries(cases)) answers[name] = await one(send);
console.log(JSON.stringify(answers));
