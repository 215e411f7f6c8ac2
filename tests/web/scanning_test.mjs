// A scan while it runs, as somebody beside the scanner sees it on a desk and on a phone: the
// camera's images, the way back when it is lost, coverage, and how far all that is behind.
//
//   node --test tests/web/scanning_test.mjs
//
// HERMITE_BUILD: where the programs are (build/release).
import assert from 'node:assert/strict';
import { mkdir, mkdtemp, rm } from 'node:fs/promises';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { barriers, openBrowser, openPage, tooSmall, until, untilScan } from './browser.mjs';
import { root, startServer, startStream } from './programs.mjs';

const artifacts = path.join(root, 'tests/web/artifacts');
// From this frame on a hand is in front of the lens, for longer than the test takes.
const covered = 20;
const sequence = `synthetic:frames=4000,rate=15,width=160,height=120+covered=${covered}:3000`;
const scan_ms = 120_000; // two slow cores do three things at once here

let folder, server, browser, viewer, client;

// In place of the one before.
function stream(recording, title) {
  client?.stop();
  client = startStream(server, { sequence: recording, title, rate: '4' });
}

before(async () => {
  await mkdir(artifacts, { recursive: true });
  folder = await mkdtemp(path.join(os.tmpdir(), 'hermite-scanning-'));
  server = await startServer(folder);
  browser = await openBrowser();
  stream('synthetic:frames=4000,rate=15,width=160,height=120', 'Hall');
});

after(async () => {
  client?.stop();
  await browser?.close();
  await server?.stop();
  if (folder) await rm(folder, { recursive: true, force: true });
});

const screenshot = (page, name) => page.screenshot({ path: path.join(artifacts, `${name}.png`) });
// Buttons whose text does not fit into them.
const cutOff = (page) =>
  page.evaluate(() =>
    [...document.querySelectorAll('button, .segments span')]
      .filter((node) => node.checkVisibility() && node.scrollWidth > node.clientWidth + 1)
      .map((node) => node.textContent),
  );
// How many different colours an image has that is seen, 0 where it is not.
const colorsOf = (page, selector) =>
  until(
    page,
    `an image in ${selector}`,
    (where) => {
      const canvas = document.querySelector(`${where} canvas.frame-image:not(.missing)`);
      // A width of 300 says that nothing was drawn yet.
      if (!canvas?.checkVisibility() || canvas.width === 300) return 0;
      return new Set(
        new Uint32Array(
          canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer,
        ),
      ).size;
    },
    selector,
    60_000,
  );

test('what the camera sees is shown beside the model, with how far it is behind', {
  timeout: scan_ms,
}, async () => {
  viewer = await openPage(browser.context, `${server.origin}/#token=${server.token}`);
  const { page } = viewer;
  await page.getByRole('link', { name: 'Hall' }).click({ timeout: 60_000 });
  assert.ok((await colorsOf(page, '.frame-picture:nth-child(2)')) > 100, 'the colour image');
  assert.ok((await colorsOf(page, '.frame-picture:nth-child(3)')) > 50, 'the depth image');
  await page
    .locator('.live-behind')
    .getByText(/^Delay: .*images (less than )?\d/)
    .waitFor({ timeout: 30_000 });
});

test('a camera that is lost is shown what to go back to, in a picture and in the model', {
  timeout: scan_ms,
}, async () => {
  const { page } = viewer;
  stream(sequence, 'Kitchen');
  await page.goto(`${server.origin}/#/`);
  await page.getByRole('link', { name: 'Kitchen' }).click({ timeout: 60_000 });
  const scan = await untilScan(
    page,
    'the camera is lost',
    scan_ms,
    (state) => state.tracking === 'lost' && state.wayBack !== null,
  );
  assert.equal(scan.wayBack.sequence, covered - 1, 'the last frame before the hand');
  await page.getByText('Camera lost. Go back to this view:').waitFor();
  assert.ok((await colorsOf(page, '.way-back')) > 100, 'it is the view before the hand');
  await page.getByText(/^Go back here, seen/).waitFor();
  assert.equal(
    await page.getByRole('button', { name: 'Close the camera’s images' }).isVisible(),
    false,
    'it stays while it is needed',
  );
  await page.getByRole('button', { name: 'Look from there' }).click();
  assert.deepEqual(await barriers(page), []);
  await screenshot(page, 'lost');
});

test('coverage says what needs another look, in colours and in stripes', {
  timeout: scan_ms,
}, async () => {
  const { page } = viewer;
  await page.locator('.picture').press('v');
  const share = page
    .locator('.coverage li')
    .filter({ hasText: 'Needs another look' })
    .getByText(/^\d+ %$/);
  await share.waitFor({ timeout: 60_000 });
  const shares = await page.locator('.coverage-share').allTextContents();
  const sum = shares.reduce((total, share) => total + Number.parseInt(share, 10), 0);
  assert.ok(Math.abs(sum - 100) <= 1, `together they are everything: ${shares}`);
  assert.equal(
    await page.getByRole('button', { name: 'Coverage' }).getAttribute('aria-pressed'),
    'true',
  );
  await untilScan(
    page,
    'coverage is on the surface',
    60_000,
    (state) => state.triangles > 0 && state.surfaceHasConfidences === true,
  );
  assert.ok(await page.locator('.segments.show').isVisible(), 'points can be chosen instead');
  assert.deepEqual(await barriers(page), []);
  await screenshot(page, 'coverage');
  await page.locator('.picture').press('v');
  await page.locator('.coverage').waitFor({ state: 'hidden' });
});

test('a share link is told that the camera is lost, and gets none of its images', {
  timeout: scan_ms,
}, async () => {
  const { page } = viewer;
  const asked = [];
  await page.getByRole('button', { name: 'Share' }).click();
  const field = page.getByLabel('Link to this scan');
  await field.waitFor();
  const context = await browser.browser.newContext();
  const guest = await context.newPage();
  guest.on('request', (request) => request.url().includes('/frames/') && asked.push(request.url()));
  await guest.goto(await field.inputValue());
  await guest
    .getByText('Camera lost. It has to go back to the red place.')
    .waitFor({ timeout: 60_000 });
  assert.equal(await guest.getByRole('button', { name: 'Camera', exact: true }).isVisible(), false);
  assert.equal(await guest.locator('.frame-image').filter({ visible: true }).count(), 0);
  assert.deepEqual(asked, []);
  await context.close();
  await page.goto(`${server.origin}/#/`); // the processor draws for the phones from here on
});

// How long the scan has been going and how fast its frames come is in the bar, beside its title.
async function paceFits(page, viewport) {
  await page
    .locator('.pace')
    .getByText(/^\d+:\d\d · \d+[.,]\d fps$/)
    .waitFor({ timeout: 30_000 });
  for (const width of viewport.width < 500 ? [360, 412, viewport.width] : [viewport.width]) {
    await page.setViewportSize({ ...viewport, width });
    const [pace, phase, menu] = await Promise.all(
      ['.pace', '.phase .mark', '.title-bar .menu-button'].map((selector) =>
        page.locator(selector).boundingBox(),
      ),
    );
    assert.ok(phase.x + phase.width <= pace.x, `beside the phase at ${width} px`);
    assert.ok(Math.abs(pace.y - phase.y) < pace.height / 2, `in one line with it at ${width} px`);
    assert.ok(pace.x + pace.width <= menu.x, `before the menu at ${width} px`);
    assert.ok(
      await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth),
      `nothing is beside the screen at ${width} px`,
    );
  }
}

const phones = [
  {
    name: 'upright',
    viewport: { width: 390, height: 844 },
    locale: 'de-DE',
    lost: 'Kamera verloren. Zurück zu dieser Ansicht:',
  },
  {
    name: 'lying',
    viewport: { width: 844, height: 390 },
    locale: 'en-GB',
    lost: 'Camera lost. Go back to this view:',
  },
];
for (const { name, viewport, locale, lost } of phones)
  test(`a phone beside the scanner has everything in reach, ${name}, in ${locale}`, {
    timeout: scan_ms,
  }, async () => {
    const context = await browser.browser.newContext({
      viewport,
      locale,
      deviceScaleFactor: 2,
      hasTouch: true,
      isMobile: true,
      colorScheme: 'light',
      reducedMotion: 'reduce',
    });
    // Its clock is wrong, which must not show.
    await context.addInitScript(() => {
      const now = Date.now;
      Date.now = () => now() - 3 * 3_600_000;
    });
    const { page, complaints } = await openPage(context, `${server.origin}/#token=${server.token}`);
    await page.getByRole('link', { name: 'Kitchen' }).click();
    await colorsOf(page, '.way-back');
    await screenshot(page, `phone-${name}-lost`);
    await page.getByText(lost).waitFor();
    assert.equal(await page.evaluate(() => document.documentElement.lang), locale.slice(0, 2));
    await paceFits(page, viewport);
    assert.deepEqual(await tooSmall(page), []);
    assert.deepEqual(await cutOff(page), []);
    const boxOf = (selector) => page.locator(selector).boundingBox();
    const [live, view, stage] = await Promise.all(
      ['.card.live', '.card.view', '.stage'].map(boxOf),
    );
    assert.ok(view.height <= 2 * 44 + 36, 'the buttons take two rows at most');
    assert.ok(live.y + live.height <= view.y, 'the images are not over the buttons');
    assert.ok(
      live.y + live.height <= stage.y + 60 || live.x + live.width <= stage.x,
      'and not over the model',
    );
    await page.locator('.unfold').tap(); // the rest is behind it
    await page.locator('.segments.mesh-color').waitFor();
    assert.deepEqual(await tooSmall(page), []);
    assert.deepEqual(await cutOff(page), []);
    assert.deepEqual(complaints, []);
    await context.close();
  });

test('nothing went wrong in the browser', () => {
  assert.deepEqual(viewer.complaints, []);
});
