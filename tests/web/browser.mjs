// A real Chromium without a screen, and what the test asks of its pages.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { mkdir, mkdtemp, rm } from 'node:fs/promises';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { root, startServer } from './programs.mjs';

const require = createRequire(path.join(root, 'web/package.json'));
const { chromium } = require('playwright-core');
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

// WebGL 2 comes from SwiftShader: no graphics card needed.
const flags = [
  '--no-sandbox',
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--disable-background-networking',
  '--disable-component-update',
  '--webgl-antialiasing-mode=none',
];

export async function openBrowser() {
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: flags,
  });
  // A small window without glides: images are drawn by the processor, which also makes the scan.
  const viewport = { width: 1024, height: 640 };
  const context = await browser.newContext({
    viewport,
    acceptDownloads: true,
    colorScheme: 'dark',
    reducedMotion: 'reduce',
  });
  return { browser, context, close: () => browser.close() };
}

// A server without scans and a browser, for the tests of one file. `artifacts`: where images go,
// HERMITE_ARTIFACTS or the server's folder. `more`: settings of the server.
export async function openServerAndBrowser(name, more = []) {
  const folder = await mkdtemp(path.join(os.tmpdir(), `hermite-${name}-`));
  const opened = { folder, artifacts: process.env.HERMITE_ARTIFACTS ?? folder };
  opened.close = async () => {
    await opened.browser?.close();
    await opened.server?.stop();
    await rm(folder, { recursive: true, force: true });
  };
  try {
    await mkdir(opened.artifacts, { recursive: true });
    opened.server = await startServer(path.join(folder, 'data'), 0, more);
    opened.browser = await openBrowser();
  } catch (error) {
    await opened.close();
    throw error;
  }
  return opened;
}

// A page together with everything it complained about. While `outage.on`, a connection that is
// refused is no complaint.
export async function openPage(context, url) {
  const page = await context.newPage();
  const complaints = [];
  const outage = { on: false };
  const isOfOutage =
    /ERR_CONNECTION_(REFUSED|RESET|CLOSED)|WebSocket connection to|ERR_EMPTY_RESPONSE/;
  const complain = (message) => {
    if (outage.on && isOfOutage.test(message)) return;
    complaints.push(message);
  };
  // WebGL by the processor is slow, and says so.
  const isOfSlowDriver = (text) => text.includes('GL Driver Message (OpenGL, Performance');
  page.on(
    'console',
    (message) =>
      ['error', 'warning'].includes(message.type()) &&
      !isOfSlowDriver(message.text()) &&
      complain(`${message.type()}: ${message.text()}`),
  );
  page.on('pageerror', (error) => complain(`exception: ${error.message}`));
  await page.exposeFunction('reportViolation', (message) => complain(`policy: ${message}`));
  await page.addInitScript(() => {
    document.addEventListener('securitypolicyviolation', (event) =>
      window.reportViolation(`${event.violatedDirective} ${event.blockedURI}`),
    );
  });
  await page.goto(url);
  return { page, complaints, outage };
}

export const scanOf = (page) => page.evaluate(() => window.hermite.scan());

// `condition` is given the state of the scan; the error has the last state in it.
export async function untilScan(page, what, limit_ms, condition) {
  const end_ms = Date.now() + limit_ms;
  for (;;) {
    const scan = await scanOf(page);
    if (scan && condition(scan)) return scan;
    if (Date.now() > end_ms)
      throw new Error(
        `after ${limit_ms} ms not yet: ${what}. The page says ${JSON.stringify(scan)}`,
      );
    await page.waitForTimeout(200);
  }
}

// What the page makes of `look`, which is given `known`, as soon as it is something.
export async function until(page, what, look, known, limit_ms = 10_000) {
  const found = await page
    .waitForFunction(look, known, { timeout: limit_ms })
    .catch(() => assert.fail(`after ${limit_ms} ms not yet: ${what}`));
  return found.jsonValue();
}

// Where the mouse could take hold of the clip box, in the middle of the image.
export const handlesOf = (page) =>
  page.evaluate(() => {
    const canvas = document.querySelector('.picture');
    const found = [];
    for (let y = 100; y < 520; y += 10)
      for (let x = 380; x < 740; x += 10) {
        canvas.dispatchEvent(
          new PointerEvent('pointermove', {
            clientX: x,
            clientY: y,
            pointerType: 'mouse',
            bubbles: true,
          }),
        );
        if (canvas.classList.contains('on-handle')) found.push([x, y]);
      }
    return found;
  });

// Until nothing moves in the image, and for a moment longer nothing begins to.
export async function untilResting(page, limit_ms = 30_000) {
  const end_ms = Date.now() + limit_ms;
  for (let quiet = 0; quiet < 3; ) {
    if (Date.now() > end_ms) throw new Error(`after ${limit_ms} ms something still moves`);
    await page.waitForTimeout(100);
    quiet = (await page.evaluate(() => window.hermite.isResting())) ? quiet + 1 : 0;
  }
}

const canvases = new WeakMap(); // by context: an empty page that decodes images

// Of the middle of the resting image, where no panel is: what `look` makes of its pixels.
async function inPixels(context, page, look) {
  await untilResting(page);
  // What is drawn is shown two images later at the latest, however busy the processor is.
  await page.evaluate(
    () => new Promise((shown) => requestAnimationFrame(() => requestAnimationFrame(shown))),
  );
  const png = await page.screenshot({ clip: { x: 60, y: 90, width: 684, height: 400 } });
  if (!canvases.has(context)) canvases.set(context, await context.newPage());
  return canvases.get(context).evaluate(
    async ([base64, body]) => {
      const image = new Image();
      image.src = `data:image/png;base64,${base64}`;
      await image.decode();
      const drawing = Object.assign(document.createElement('canvas'), {
        width: image.width,
        height: image.height,
      }).getContext('2d');
      drawing.drawImage(image, 0, 0);
      return new Function('data', `return (${body})(data)`)(
        drawing.getImageData(0, 0, image.width, image.height),
      );
    },
    [png.toString('base64'), look.toString()],
  );
}

// Share of pixels brighter than the ground, number of different colours, and
// one number for all of it.
export const lookAt = (context, page) =>
  inPixels(context, page, (data) => {
    const pixels = new Uint32Array(data.data.buffer);
    const bright = pixels.filter(
      (p) => Math.max(p & 255, (p >> 8) & 255, (p >> 16) & 255) > 70,
    ).length;
    return {
      brightShare: bright / pixels.length,
      colors: new Set(pixels).size,
      hash: pixels.reduce((sum, p) => (Math.imul(sum, 31) + p) | 0, 7),
    };
  });

// The same, coarsely: red, green and blue of squares of 20 pixels, one after the other.
export const brightnessOf = (context, page) =>
  inPixels(context, page, ({ data, width, height }) => {
    const square = 20;
    const means = [];
    for (let y = 0; y + square <= height; y += square)
      for (let x = 0; x + square <= width; x += square)
        for (let channel = 0; channel < 3; ++channel) {
          let sum = 0;
          for (let v = 0; v < square; ++v)
            for (let u = 0; u < square; ++u) sum += data[4 * ((y + v) * width + x + u) + channel];
          means.push(sum / (square * square));
        }
    return means;
  });

// Of two of these: the share of the squares that are bright in `some` and in `all`, too, and the
// mean cosine between their colours there.
export function agreement(some, all) {
  let [bright, both, cosines] = [0, 0, 0];
  for (let i = 0; i < some.length; i += 3) {
    const [a, b] = [some.slice(i, i + 3), all.slice(i, i + 3)];
    if (Math.max(...a) < 50) continue;
    ++bright;
    if (Math.max(...b) < 50) continue;
    ++both;
    cosines += (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / (Math.hypot(...a) * Math.hypot(...b));
  }
  return { covered: both / bright, alike: cosines / both };
}

// Of an image of points: how many of the pixels among bright ones are dark, seen left, right,
// above and below of them.
export const holesIn = (context, page) =>
  inPixels(context, page, ({ data, width, height }) => {
    const reach = 5;
    const bright = (x, y) =>
      Math.max(...data.subarray(4 * (y * width + x), 4 * (y * width + x) + 3)) > 50;
    let [holes, all] = [0, 0];
    for (let y = reach; y < height - reach; ++y)
      for (let x = reach; x < width - reach; ++x) {
        if (bright(x, y)) ++all;
        else if (
          bright(x - reach, y) &&
          bright(x + reach, y) &&
          bright(x, y - reach) &&
          bright(x, y + reach)
        )
          ++holes;
      }
    return holes / all;
  });

// What axe finds wrong with the page for people who see, hear or move otherwise: a line each.
export async function barriers(page) {
  await page.evaluate(axe); // not as a script of the page, which its policy forbids
  const violations = await page.evaluate(() =>
    window.axe.run(document, { resultTypes: ['violations'] }).then((results) => results.violations),
  );
  return violations.flatMap(({ id, help, nodes }) =>
    nodes.map(({ target }) => `${id}: ${help}: ${target.join(' ')}`),
  );
}

// What can be tapped and is smaller than a thumb, or beside the screen.
export const tooSmall = (page, least_px = 44) =>
  page.evaluate((least) => {
    const shown = [
      ...document.querySelectorAll(
        'button, summary, select, a, label.button, .segments label, .slider',
      ),
    ].filter((node) => node.checkVisibility());
    return shown
      .map((node) => ({
        label: node.textContent || node.ariaLabel,
        box: node.getBoundingClientRect(),
      }))
      .filter(
        ({ box }) =>
          box.height < least || box.width < least - 8 || box.left < 0 || box.right > innerWidth,
      )
      .map(({ label, box }) => {
        const [width, height, left] = [box.width, box.height, box.left].map(Math.round);
        return `${label}: ${width} x ${height} at ${left}`;
      });
  }, least_px);
