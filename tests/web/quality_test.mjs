// The page of a scan's quality in a real browser, of a real scan in which a
// hand was before the lens.
//
//   node --test tests/web/quality_test.mjs
//
// HERMITE_BUILD: where the programs are (build/release). HERMITE_ARTIFACTS: where images go.
import assert from 'node:assert/strict';
import { mkdir, mkdtemp, rm } from 'node:fs/promises';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { barriers, openBrowser, openPage, tooSmall } from './browser.mjs';
import { startServer, startStream } from './programs.mjs';

// Where others keep the machine busy, the server makes the surface last.
const limit_ms = 3 * 60_000;
const title = 'Hand before the lens';
let folder, artifacts, server, browser, viewer, api;

before(async () => {
  folder = await mkdtemp(path.join(os.tmpdir(), 'hermite-quality-'));
  artifacts = process.env.HERMITE_ARTIFACTS;
  if (artifacts) await mkdir(artifacts, { recursive: true });
  server = await startServer(path.join(folder, 'data'));
  const streamed = startStream(server, {
    sequence: 'synthetic:frames=24,width=160,height=120+covered=10:6',
    title,
  });
  browser = await openBrowser();
  assert.equal(await streamed.end(limit_ms), 0, streamed.output());
  const headers = { Authorization: `Bearer ${server.token}` };
  const { scans } = await (await fetch(`${server.origin}/api/v1/scans`, { headers })).json();
  api = { headers, scan: `${server.origin}/api/v1/scans/${scans[0].id}` };
  viewer = await openPage(
    browser.context,
    `${server.origin}/#token=${server.token}&scan=${scans[0].id}`,
  );
  viewer.page.setDefaultTimeout(limit_ms);
});

after(async () => {
  await browser?.close();
  await server?.stop();
  if (folder) await rm(folder, { recursive: true, force: true });
});

const screenshot = async (page, name) =>
  artifacts && page.screenshot({ path: path.join(artifacts, `${name}.png`), fullPage: true });
// Of each image of the model, the share of its pixels that show something.
const filled = (page) =>
  page.locator('.model-picture canvas').evaluateAll((all) =>
    all.map((canvas) => {
      const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
      return data.filter((value, i) => i % 4 === 3 && value > 200).length / (data.length / 4);
    }),
  );

test('the scan says in a sentence how it went, and its counters are behind Details', {
  timeout: limit_ms,
}, async () => {
  const { page } = viewer;
  await page
    .locator('.summary')
    .getByText(
      new RegExp(
        '^The camera was followed in \\d+ of 24 frames.* It was lost once, for 0\\.2 s\\. ' +
          'Its path should be right to about \\d+ [cm]m, calibration aside\\.$',
      ),
    )
    .waitFor();
  assert.equal(await page.getByText('Keyframes').isVisible(), false);
  await page.getByText('Details', { exact: true }).click();
  await page.locator('.figures').getByText('Keyframes').waitFor();
  await page.locator('.figures').getByText('Complete').waitFor();
});

test('its quality is a page to print, with a strip, doubtful places and pictures', {
  timeout: limit_ms,
}, async () => {
  const { page } = viewer;
  await page.keyboard.press('q');
  await page.getByRole('heading', { name: title }).waitFor();
  await page.locator('.model-picture').nth(5).waitFor();
  assert.ok(Math.max(...(await filled(page))) > 0.1, 'the model is in its pictures');
  assert.deepEqual(
    await page
      .locator('.strip rect')
      .evaluateAll((all) =>
        [...new Set(all.map((rect) => rect.getAttribute('class')))].filter(
          (name) => name !== 'strip-weak',
        ),
      ),
    ['strip-tracked', 'strip-lost'],
  );
  await page.getByText('there is no depth').waitFor();
  await page
    .locator('.doubt', { hasText: 'Too few points: the depth camera sees almost nothing.' })
    .first()
    .waitFor();
  assert.deepEqual(await barriers(page), []);
  await screenshot(page, 'quality');
  await page.emulateMedia({ media: 'print' });
  assert.equal(await page.getByRole('button', { name: 'Print' }).isVisible(), false);
  assert.equal(
    await page.evaluate(() => getComputedStyle(document.body).color),
    'rgb(0, 0, 0)',
    'black on white, also where the screen is dark',
  );
  await screenshot(page, 'quality-print');
  await page.emulateMedia({ media: 'screen' });
  await page.setViewportSize({ width: 390, height: 844 });
  assert.deepEqual(await tooSmall(page), []);
  await screenshot(page, 'quality-phone');
  await page.setViewportSize({ width: 1024, height: 640 });
  const { x, y, width } = await page.locator('.strip').boundingBox();
  await page.mouse.click(x + 0.54 * width, y + 20);
  await page.locator('.frame-facts').getByText('Frame 12 / 23').waitFor();
  await page.locator('.frame-facts').getByText('Lost').waitFor();
  await page
    .locator('.frame-reason', { hasText: 'Too few points: the depth camera sees almost nothing.' })
    .waitFor();
});

test('a long scan of an older server, a link of somebody, and a scan that is deleted', {
  timeout: limit_ms,
}, async () => {
  const { page } = viewer;
  const timestamps_s = Array.from({ length: 18_000 }, (_, i) => i / 30);
  const statuses = Array.from({ length: 9_000 }, (_, i) => ({
    status: i % 2 ? 'weak' : 'tracked',
    frames: 2,
  }));
  await page.route('**/frames', (route) =>
    route.fulfill({ json: { width: 160, height: 120, timestamps_s, statuses } }),
  );
  await page.route('**/report.json', (route) => route.fulfill({ json: { surfels: 3 } }));
  await page.goBack();
  await page
    .getByText(
      'The camera was followed in all of 18,000 frames; 9,000 of them are doubtful, for 5 min 0 s in all.',
    )
    .waitFor();
  const pieces = await page.locator('.strip rect').count();
  assert.ok(pieces > 0 && pieces <= 600, `${pieces} pieces in the strip of 18,000 frames`);

  const { path: link } = await (
    await fetch(`${api.scan}/shares`, { method: 'POST', headers: api.headers, body: '{}' })
  ).json();
  const context = await browser.browser.newContext();
  const guest = await openPage(context, `${server.origin}${link}&page=quality`);
  guest.page.setDefaultTimeout(limit_ms);
  await guest.page
    .getByText('This link shows the model and not what the camera has seen')
    .waitFor();
  assert.equal(await guest.page.locator('.strip, .doubt').count(), 0);
  assert.deepEqual(guest.complaints, []);
  await context.close();

  const germanContext = await browser.browser.newContext({ locale: 'de-DE' });
  const german = await openPage(germanContext, `${server.origin}${link}&page=quality`);
  german.page.setDefaultTimeout(limit_ms);
  await german.page.getByRole('heading', { name: 'Die Kamera', exact: true }).waitFor();
  await german.page.getByText(/^Die Kamera wurde in \d+ von 24 Bildern verfolgt/).waitFor();
  assert.equal(await german.page.evaluate(() => document.documentElement.lang), 'de');
  assert.deepEqual(german.complaints, []);
  await germanContext.close();

  assert.deepEqual(viewer.complaints, []);
  await fetch(api.scan, { method: 'DELETE', headers: api.headers });
  await page.evaluate(() => document.dispatchEvent(new Event('visibilitychange')));
  await page.getByText('This scan has been deleted.').waitFor();
});
