// The real server and the real client as child processes, for the browser's test.
import { spawn } from 'node:child_process';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

export const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
const build = path.resolve(root, process.env.HERMITE_BUILD ?? 'build/release');
const keptOutput_chars = 20_000;

// Runs until it is stopped or ends by itself. `output()` is the end of what it said.
function start(program, args, env = {}) {
  const child = spawn(path.join(build, 'server', program), args, {
    cwd: root,
    env: { ...process.env, ...env },
    stdio: ['ignore', 'pipe', 'pipe'],
  });
  let said = '';
  const listeners = new Set();
  for (const stream of [child.stdout, child.stderr]) {
    stream.setEncoding('utf8').on('data', (text) => {
      said = (said + text).slice(-keptOutput_chars);
      for (const listener of listeners) listener();
    });
  }
  const ended = new Promise((resolve) => {
    child.on('error', (error) => resolve(`could not be started: ${error.message}`));
    child.on('exit', (code, signal) => resolve(code ?? signal));
  });
  return { child, ended, output: () => said, onOutput: (listener) => listeners.add(listener) };
}

function within(limit_ms, promise, message) {
  let timer;
  const late = new Promise(
    (_, reject) => (timer = setTimeout(() => reject(new Error(message())), limit_ms)),
  );
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

// `port` 0: any free one. Resolves once the server says where it is.
export async function startServer(dataFolder, port = 0, more = []) {
  const args = [
    'serve',
    '--listen',
    `127.0.0.1:${port}`,
    '--data',
    dataFolder,
    '--web-dir',
    path.join(root, 'web/dist'),
    ...more,
  ];
  const server = start('hermite', args);
  const address = new Promise((resolve) => {
    server.onOutput(() => {
      const found = /(http:\/\/127\.0\.0\.1:(\d+))\/#token=(\w+)/.exec(server.output());
      if (found) resolve({ origin: found[1], port: Number(found[2]), token: found[3] });
    });
  });
  const failed = server.ended.then((end) => {
    throw new Error(`hermite serve ended with ${end}:\n${server.output()}`);
  });
  const where = await within(
    60_000,
    Promise.race([address, failed]),
    () => `hermite serve does not say where it is:\n${server.output()}`,
  );
  failed.catch(() => {}); // it may end when it is told to
  return {
    ...where,
    output: server.output,
    kill() {
      server.child.kill('SIGKILL');
      return server.ended;
    },
    async stop() {
      server.child.kill('SIGTERM');
      return within(60_000, server.ended, () => 'hermite serve does not stop on SIGTERM').catch(
        (error) => {
          server.child.kill('SIGKILL');
          throw error;
        },
      );
    },
  };
}

// `rate`: frames per second.
export function startStream(server, { sequence, title, rate = 'max' }) {
  const client = start(
    'hermite-client',
    ['stream', sequence, '--server', server.origin, '--title', title, '--rate', rate],
    { HERMITE_TOKEN: server.token },
  );
  return {
    output: client.output,
    end: (limit_ms) =>
      within(
        limit_ms,
        client.ended,
        () => `hermite-client is not done after ${limit_ms} ms:\n${client.output()}`,
      ),
    stop: () => client.child.kill('SIGKILL'),
  };
}
