// A recording on its way from a real browser to the real server: through a server that is killed
// and a page that is loaded again.
//
//   node --test tests/web/upload_test.mjs
//
// HERMITE_BUILD: where the programs are (build/release).
import assert from 'node:assert/strict';
import { randomBytes } from 'node:crypto';
import { mkdtemp, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { openBrowser, openPage } from './browser.mjs';
import { startServer } from './programs.mjs';

const size_bytes = 40 * 1024 * 1024; // three pieces
const link_bytes_per_s = 8_000_000; // so that there is time to break it
const sent_ms = 3 * 60_000;

let folder, server, browser, viewer;
const bytes = randomBytes(size_bytes);
const asked = [];

before(async () => {
  folder = await mkdtemp(path.join(os.tmpdir(), 'hermite-upload-'));
  await writeFile(path.join(folder, 'noise.tar'), bytes);
  server = await startServer(path.join(folder, 'data'));
  browser = await openBrowser();
  viewer = await openPage(browser.context, `${server.origin}/#token=${server.token}`);
  viewer.page.on(
    'request',
    (request) => request.url().includes('/api/v1/uploads') && asked.push(request.method()),
  );
  const tools = await browser.context.newCDPSession(viewer.page);
  await tools.send('Network.enable');
  await tools.send('Network.emulateNetworkConditions', {
    offline: false,
    latency: 0,
    downloadThroughput: -1,
    uploadThroughput: link_bytes_per_s,
  });
});

after(async () => {
  await browser?.close();
  await server?.stop();
  if (folder) await rm(folder, { recursive: true, force: true });
});

// The first percentage beyond `least` that the page names.
async function sentBeyond(least) {
  const end_ms = Date.now() + sent_ms;
  for (;;) {
    const text = (await viewer.page.locator('.jobs-panel .notice').textContent()) ?? '';
    const found = /^Sending noise\.tar: (\d+) %$/.exec(text);
    if (found && Number(found[1]) > least) return Number(found[1]);
    if (Date.now() > end_ms) throw new Error(`never more than ${least} %: ${text}`);
    await viewer.page.waitForTimeout(50);
  }
}

const addFile = () =>
  viewer.page.locator('#recordings').setInputFiles(path.join(folder, 'noise.tar'));

test('an upload survives a killed server and a reload, and every byte arrives once', {
  timeout: 2 * sent_ms,
}, async () => {
  const { page, outage } = viewer;
  await page.getByText('No scans yet.').waitFor();
  await addFile();
  await sentBeyond(5);

  // It goes on while another page is looked at.
  await page.evaluate((id) => (location.hash = `#/scan/${id}`), 'a'.repeat(26));
  await page.getByText('This scan does not exist').waitFor();
  await page.evaluate(() => (location.hash = '#/'));
  await sentBeyond(10);

  outage.on = true;
  await server.kill();
  await page.getByText(/waiting for the server/).waitFor();
  server = await startServer(path.join(folder, 'data'), server.port);
  await sentBeyond(50);
  outage.on = false;

  await page.reload();
  await page
    .getByText('noise.tar was not sent to the end. Add it again and it goes on from there.')
    .waitFor();
  await addFile();
  const first = await sentBeyond(0);
  assert.ok(first >= 40, `goes on at ${first} %: a whole piece had arrived before the reload`);

  await page.getByText(/noise is no recording we know/).waitFor({ timeout: sent_ms });
  assert.equal(
    asked.filter((method) => method === 'POST').length,
    1,
    `one upload all the time: ${asked.join(' ')}`,
  );
  assert.ok(
    asked.filter((method) => method === 'HEAD').length >= 2,
    `the server was asked what had arrived: ${asked.join(' ')}`,
  );
  const uploads = path.join(folder, 'data', 'uploads');
  const kept = await Promise.all(
    (await readdir(uploads)).map((name) => readFile(path.join(uploads, name))),
  );
  assert.equal(kept.length, 1);
  assert.ok(kept[0].equals(bytes), 'byte for byte what was sent');
  assert.equal(await page.getByText('was not sent to the end').count(), 0);
  assert.deepEqual(viewer.complaints, []);
});
