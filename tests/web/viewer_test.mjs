// The whole path in a real browser: server, client and viewer as a person uses them. Asserts on states and pixels, never on speed.
//
//   node --test tests/web/viewer_test.mjs      HERMITE_BUILD: where the programs are (build/release)
//
// Pictures are kept in tests/web/artifacts.
import assert from 'node:assert/strict';
import { mkdir, mkdtemp, readFile, rm } from 'node:fs/promises';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { lookAt, openBrowser, openPage, scanOf, untilScan } from './browser.mjs';
import { root, startServer, startStream } from './programs.mjs';

const artifacts = path.join(root, 'tests/web/artifacts');
const title = 'Synthetic room';
const sequence = 'synthetic:frames=40,rate=15';
const scan_ms = 5 * 60_000; // two slow cores do three things at once here

let folder, server, browser, viewer;
const processes = [];

before(async () => {
  await mkdir(artifacts, { recursive: true });
  folder = await mkdtemp(path.join(os.tmpdir(), 'hermite-viewer-'));
  server = await startServer(folder);
  browser = await openBrowser();
});

after(async () => {
  for (const process of processes) process.stop();
  await browser?.close();
  await server?.stop();
  if (folder) await rm(folder, { recursive: true, force: true });
});

const picture = (name) => viewer.page.screenshot({ path: path.join(artifacts, `${name}.png`) });
const stream = (options) => {
  const client = startStream(server, options);
  processes.push(client);
  return client;
};

test('the list of a new server is empty and says what to do; the token leaves the address', async () => {
  viewer = await openPage(browser.context, `${server.origin}/#token=${server.token}`);
  await viewer.page.getByText('No scans yet.').waitFor();
  assert.equal(viewer.page.url(), `${server.origin}/#/`);
});

test('a page without the token is told so', async () => {
  const context = await browser.browser.newContext();
  const stranger = await context.newPage();
  await stranger.goto(server.origin);
  await stranger.getByText('This server asks for an access token.').waitFor();
  await stranger.getByLabel('Access token').fill(server.token);
  await stranger.getByRole('button', { name: 'Continue' }).click();
  await stranger.getByText('No scans yet.').waitFor();
  await context.close();
});

test('a file that is added becomes a job, which says why it failed', async () => {
  const page = viewer.page;
  await page.locator('#recordings').setInputFiles({ name: 'holiday.tar', mimeType: 'application/x-tar', buffer: Buffer.from('no recording') });
  await page.getByText('holiday', { exact: true }).waitFor();
  await page.getByText(/holiday is no recording we know/).waitFor();
  await page.getByRole('button', { name: 'Try again' }).click();
  await page.getByText(/holiday is no recording we know/).waitFor();
  await picture('failed-job');
});

test('a scan is seen while it grows', { timeout: scan_ms + 60_000 }, async () => {
  const client = stream({ sequence, title });
  const { page } = viewer;
  const row = page.getByRole('link', { name: title });
  await row.waitFor({ timeout: 60_000 });
  await picture('list');
  await row.click();

  const first = await untilScan(page, 'points and a pose of a running scan', scan_ms, (scan) => scan.points > 0 && scan.cameraPosition_m !== null);
  assert.equal(first.title, title);
  await untilScan(page, 'the camera has moved 5 cm', scan_ms, (scan) => {
    const moved = scan.cameraPosition_m.map((value, axis) => value - first.cameraPosition_m[axis]);
    return Math.hypot(...moved) > 0.05;
  });
  await picture('growing');

  const last = await untilScan(page, 'the scan is finished and whole', scan_ms, (scan) => scan.phase === 'finished' && scan.connection === 'closed');
  assert.equal(await client.end(60_000), 0, client.output());
  assert.equal(last.framesProcessed, 40);
  assert.equal(last.framesDropped, 0);
  assert.equal(last.failedChunks, 0);
  assert.ok(last.submaps > 0, 'the viewer knows the submaps');
  assert.equal(last.parts, 1);
  assert.ok(last.keyframes > 0, 'and how many keyframes there are');
  assert.ok(last.points > first.points, `${first.points} points grew to ${last.points}`);
  assert.equal(last.problem, null);
});

test('the picture shows the room, in the colours asked for', async () => {
  const { page } = viewer;
  await page.waitForTimeout(2000); // the eye comes to rest
  const colored = await lookAt(browser.context, page);
  assert.ok(colored.brightShare > 0.1, `${colored.brightShare} of the picture is bright`);
  assert.ok(colored.colors > 1000, `${colored.colors} colours`);
  await picture('finished');

  await page.getByText('Normals').click();
  await page.waitForTimeout(2000);
  const normals = await lookAt(browser.context, page);
  assert.ok(normals.brightShare > 0.1, `${normals.brightShare} of the picture is bright`);
  await picture('normals');
  await page.getByText('Colour', { exact: true }).click();
});

test('the cloud can be downloaded', async () => {
  const download = viewer.page.waitForEvent('download');
  await viewer.page.getByRole('button', { name: 'Download PLY' }).click();
  const file = await download;
  assert.equal(file.suggestedFilename(), 'Synthetic_room.ply');
  const head = (await readFile(await file.path())).subarray(0, 2000).toString('latin1');
  assert.match(head, /^ply\n/);
  assert.ok(Number(/element vertex (\d+)/.exec(head)[1]) > 1000, head);
});

test('a share link shows this scan and no other', { timeout: 120_000 }, async () => {
  const { page } = viewer;
  await page.getByRole('button', { name: 'Share' }).click();
  const field = page.getByLabel('Link to this scan');
  await field.waitFor(); // it is there before, but hidden and empty
  const link = await field.inputValue();
  assert.ok(link.startsWith(`${server.origin}/#share=hms_`), link);
  const context = await browser.browser.newContext();
  const guest = await context.newPage();
  await guest.goto(link);
  await untilScan(guest, 'the shared scan', 60_000, (scan) => scan.snapshotComplete && scan.points > 0);
  assert.ok(!guest.url().includes('hms_'), 'the secret leaves the address');
  assert.equal(await guest.getByRole('button', { name: 'Share' }).count(), 0);
  await guest.goto(`${server.origin}/#/`);
  await guest.getByRole('link', { name: title }).waitFor();
  assert.equal(await guest.locator('.scan-row').count(), 1);
  await context.close();
});

test('a finished scan looks the same when it is opened again, also from a restarted server', async () => {
  const { page } = viewer;
  const before = await scanOf(page);
  const again = async (words) => {
    const scan = await untilScan(page, words, 60_000, (state) => state.snapshotComplete && state.phase === 'finished');
    assert.equal(scan.points, before.points, words);
    assert.equal(scan.chunks, before.chunks, words);
    assert.ok(scan.poses > 0, 'the trajectory is there');
    assert.equal(scan.submaps, before.submaps, words);
    assert.equal(scan.keyframes, before.keyframes, words);
  };
  await page.reload();
  await again('loaded again');
  await server.stop();
  server = await startServer(folder, server.port);
  await page.reload();
  await again('loaded from the restarted server');
});

test('a page comes back by itself when the server does', { timeout: scan_ms }, async () => {
  const { page, outage } = viewer;
  const client = stream({ sequence: 'synthetic:frames=2000,width=320,height=240', title: 'Long scan' });
  await page.goto(`${server.origin}/#/`);
  await page.getByRole('link', { name: 'Long scan' }).click();
  await untilScan(page, 'points of the long scan', 120_000, (scan) => scan.points > 0);

  outage.on = true;
  await server.kill(); // told to stop, it would have sent everything and said that the scan has ended
  client.stop();
  await untilScan(page, 'the page says that it waits', 30_000, (scan) => scan.connection === 'waiting');
  await picture('server_gone');
  // It builds the scan again, and does not wait long for a camera that is dead.
  server = await startServer(folder, server.port, ['--resume-window', '1']);
  await untilScan(page, 'the page is back', 120_000, (scan) => scan.snapshotComplete && scan.phase === 'interrupted');
  outage.on = false;
  await page.getByText('Interrupted').first().waitFor();
});

test('a scan that does not exist is said to be so', async () => {
  const { page } = viewer;
  await page.goto(`${server.origin}/#/scan/${'a'.repeat(26)}`);
  await page.getByText('This scan does not exist, or no longer.').waitFor();
});

test('nothing went wrong in the browser', () => {
  assert.deepEqual(viewer.complaints, []);
});
