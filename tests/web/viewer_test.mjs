// The whole path in a real browser: server, client and viewer as a person uses them. Asserts on
// states and pixels, never on speed.
//
//   node --test tests/web/viewer_test.mjs
//
// HERMITE_BUILD: where the programs are (build/release).
//
// Images are kept in tests/web/artifacts.
import assert from 'node:assert/strict';
import { mkdir, mkdtemp, readFile, rm } from 'node:fs/promises';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import {
  agreement,
  barriers,
  brightnessOf,
  handlesOf,
  holesIn,
  lookAt,
  openBrowser,
  openPage,
  scanOf,
  tooSmall,
  until,
  untilResting,
  untilScan,
} from './browser.mjs';
import { root, startServer, startStream } from './programs.mjs';

const artifacts = path.join(root, 'tests/web/artifacts');
const title = 'Synthetic room';
const sequence = 'synthetic:frames=36,rate=15,width=320,height=240';
const endless = 'synthetic:frames=5000,width=160,height=120';
// Frames a second of scans whose end nobody waits for: the rest of two cores is for the page.
const slowly = '5';
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

const screenshot = (name) => viewer.page.screenshot({ path: path.join(artifacts, `${name}.png`) });
// The choice between surface and points.
const showAs = (page, name) =>
  page.locator('.segments.show').getByText(name, { exact: true }).click();
const stream = (options) => {
  const client = startStream(server, options);
  processes.push(client);
  return client;
};

test('an empty list says what to do, and the token leaves the address', async () => {
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
  await page.locator('#recordings').setInputFiles({
    name: 'holiday.tar',
    mimeType: 'application/x-tar',
    buffer: Buffer.from('no recording'),
  });
  await page.getByText('holiday', { exact: true }).waitFor();
  await page.getByText(/holiday is no recording we know/).waitFor();
  await page.getByRole('button', { name: 'Try again' }).click();
  await page.getByText(/holiday is no recording we know/).waitFor();
  await screenshot('failed-job');
  await page.getByRole('button', { name: 'Dismiss: holiday' }).click();
  await page.getByText('holiday', { exact: true }).waitFor({ state: 'detached' });
});

test('a scan is seen while it grows', { timeout: scan_ms + 60_000 }, async () => {
  // A fast machine would otherwise be done before the page is there.
  const client = stream({ sequence, title, rate: '5' });
  const { page } = viewer;
  const row = page.getByRole('link', { name: title });
  await row.waitFor({ timeout: 60_000 });
  await row.click();

  const first = await untilScan(
    page,
    'triangles and a pose of a running scan',
    scan_ms,
    (scan) => scan.triangles > 0 && scan.cameraPosition_m !== null,
  );
  assert.equal(first.phase, 'running');
  assert.equal(first.points, 0, 'points are not sent where nobody looks at them');
  assert.equal(first.title, title);
  await untilScan(page, 'the camera has moved 5 cm', scan_ms, (scan) => {
    const moved = scan.cameraPosition_m.map((value, axis) => value - first.cameraPosition_m[axis]);
    return Math.hypot(...moved) > 0.05;
  });
  await screenshot('growing');
  await showAs(page, 'Points');
  await untilScan(page, 'points of a running scan', scan_ms, (scan) => scan.points > 0);
  await showAs(page, 'Surface');

  const last = await untilScan(
    page,
    'the scan is finished and whole',
    scan_ms,
    (scan) => scan.phase === 'finished' && scan.connection === 'closed',
  );
  assert.equal(await client.end(60_000), 0, client.output());
  assert.equal(last.framesProcessed, 36);
  assert.equal(last.framesDropped, 0);
  assert.equal(last.failedChunks, 0);
  assert.ok(last.submaps > 0, 'the viewer knows the submaps');
  assert.equal(last.parts, 1);
  assert.ok(last.keyframes > 0, 'and how many keyframes there are');
  assert.ok(last.points > 1000, `${last.points} points`);
  assert.equal(last.problem, null);
});

test('the picture shows the room, in the colours asked for', async () => {
  const { page } = viewer;
  const colored = await lookAt(browser.context, page);
  assert.ok(colored.brightShare > 0.1, `${colored.brightShare} of the picture is bright`);
  assert.ok(colored.colors > 1000, `${colored.colors} colours`);
  await screenshot('finished');

  await page.getByText('Normals').filter({ visible: true }).click();
  const normals = await lookAt(browser.context, page);
  assert.ok(normals.brightShare > 0.1, `${normals.brightShare} of the picture is bright`);
  await screenshot('normals');
  await page.getByText('Colour', { exact: true }).filter({ visible: true }).click();
});

test('the surface of a finished scan appears, and its points are a click away', {
  timeout: scan_ms,
}, async () => {
  const { page } = viewer;
  const scan = await untilScan(
    page,
    'the surface is shown',
    scan_ms,
    (state) => state.mesh.state === 'shown',
  );
  assert.ok(scan.mesh.triangles > 10_000, `${scan.mesh.triangles} triangles`);
  await page.getByLabel('Surface', { exact: true }).waitFor({ state: 'attached' });
  const surface = await lookAt(browser.context, page);
  assert.ok(surface.brightShare > 0.1, `${surface.brightShare} of the picture is bright`);
  assert.ok(surface.colors > 1000, `${surface.colors} colours`);
  await screenshot('surface');
  await showAs(page, 'Points');
  const points = await lookAt(browser.context, page);
  assert.notEqual(points.hash, surface.hash, 'points look different');
  await page.reload();
  await untilScan(
    page,
    'the surface is loaded again',
    60_000,
    (state) => state.mesh.state === 'shown',
  );
  assert.equal(
    await page.locator('input[name=show][value=points]').isChecked(),
    true,
    'points stay chosen',
  );
  await showAs(page, 'Surface');
});

test('the surface lies where the points lie', async () => {
  const { page } = viewer;
  await page.getByText('Normals').filter({ visible: true }).click();
  await page.getByRole('button', { name: 'Show all' }).click();
  const surface = await brightnessOf(browser.context, page);
  await showAs(page, 'Points');
  await page.getByText('Normals').filter({ visible: true }).click();
  const points = await brightnessOf(browser.context, page);
  // Points have gaps between them and are fewer: where they are the surface is,
  // too, and looks the same way.
  const { covered, alike } = agreement(points, surface);
  assert.ok(covered > 0.9, `of where points are, ${covered} has a surface`);
  assert.ok(alike > 0.97, `colours of normals agree by ${alike}`);
  await screenshot('points');
  const lit = await lookAt(browser.context, page);
  await page.locator('.picture').press('e'); // dark edges are no holes
  const holes = await holesIn(browser.context, page);
  assert.ok(holes < 0.01, `${holes} of the points' picture is holes: it is no sieve`);
  const flat = await lookAt(browser.context, page);
  assert.ok(
    lit.brightShare < flat.brightShare,
    `edges of points are dark: ${lit.brightShare} and ${flat.brightShare} are bright`,
  );
  assert.ok(
    lit.brightShare > 0.9 * flat.brightShare,
    `and little else is: ${lit.brightShare} and ${flat.brightShare} are bright`,
  );
  const calls = await page.evaluate(() => window.hermite.drawCalls());
  assert.ok(calls > 0 && calls <= 8, `${calls} draw calls`);
  await page.getByText('Colour', { exact: true }).filter({ visible: true }).click();
  await showAs(page, 'Surface');
  const flatSurface = await lookAt(browser.context, page);
  await page.locator('.picture').press('e');
  assert.equal(
    (await lookAt(browser.context, page)).hash,
    flatSurface.hash,
    'a surface has none of this light',
  );
});

test('the cloud and the surface can be downloaded', { timeout: scan_ms }, async () => {
  const { page } = viewer;
  const take = async (name) => {
    const download = page.waitForEvent('download', { timeout: 120_000 });
    await page.getByRole('button', { name }).click();
    const file = await download;
    return { name: file.suggestedFilename(), bytes: await readFile(await file.path()) };
  };
  await page.getByRole('button', { name: 'Download', exact: true }).click();
  const cloud = await take(/^PLY, with all/);
  assert.equal(cloud.name, 'Synthetic_room-cloud.ply');
  const head = cloud.bytes.subarray(0, 2000).toString('latin1');
  assert.match(head, /^ply\n/);
  assert.ok(Number(/element vertex (\d+)/.exec(head)[1]) > 1000, head);
  const mesh = await take(/^GLB, opens nearly everywhere/); // which the server makes first
  assert.equal(mesh.name, 'Synthetic_room-mesh.glb');
  assert.equal(mesh.bytes.subarray(0, 4).toString('latin1'), 'glTF');
  assert.equal(mesh.bytes.readUInt32LE(8), mesh.bytes.length, 'it is whole');
  const gltf = JSON.parse(mesh.bytes.subarray(20, 20 + mesh.bytes.readUInt32LE(12)).toString());
  assert.equal(gltf.asset.version, '2.0');
  assert.ok(
    gltf.accessors[gltf.meshes[0].primitives[0].indices].count > 30_000,
    'corners of triangles',
  );
  const triangles = gltf.accessors[gltf.meshes[0].primitives[0].indices].count / 3;
  await page
    .getByRole('combobox', { name: /^Triangles/ })
    .selectOption({ label: 'Far fewer, within 5 mm' });
  await page
    .getByRole('combobox', { name: /^Holes/ })
    .selectOption({ label: 'All closed, for printing' });
  await page.getByRole('button', { name: /^GLB, opens nearly everywhere *Make it/ }).waitFor();
  const print = await take(/^STL, for printing/);
  assert.equal(print.name, 'Synthetic_room-mesh_s5000_f150_c.stl');
  const left = print.bytes.readUInt32LE(80);
  assert.equal(print.bytes.length, 84 + 50 * left, 'it is whole');
  assert.ok(left > 100 && left < triangles / 2, `${left} of ${triangles} triangles`);
  await screenshot('downloads');
  await page.getByRole('combobox', { name: /^Holes/ }).selectOption({ label: 'Left open' });
  await page.getByRole('combobox', { name: /^Triangles/ }).selectOption({ label: 'All' });
  // That one is there.
  await page.getByRole('button', { name: /^GLB, opens nearly everywhere *\d/ }).waitFor();
  const made = 'STL, for printing: simplified within 5 mm, all holes closed';
  await page.getByRole('button', { name: new RegExp(`^${made} *\\d`) }).waitFor();
  await page.getByRole('button', { name: `Remove ${made}` }).click();
  await page.getByText('Made with options').waitFor({ state: 'hidden' });
  await page.keyboard.press('Escape');
  assert.equal(await page.locator('#downloads').isVisible(), false);
});

test('the floor plan is drawn and can be taken away', { timeout: scan_ms }, async () => {
  const { page } = viewer;
  await page.keyboard.press('p');
  // The server makes it first.
  const picture = page.getByRole('img', { name: 'Floor plan of Synthetic room' });
  await picture.waitFor({ timeout: 60_000 });
  assert.ok(
    (await picture.evaluate((image) => image.decode().then(() => image.naturalWidth))) > 100,
  );
  await page.locator('.zoom-frame:focus').waitFor(); // its keys work at once
  assert.deepEqual(await barriers(page), []);
  const download = page.waitForEvent('download', { timeout: 60_000 });
  await page.getByRole('dialog').getByRole('button', { name: 'DXF' }).click();
  const file = await download;
  assert.equal(file.suggestedFilename(), 'Synthetic_room-plan.dxf');
  assert.match((await readFile(await file.path())).toString('latin1'), /WALLS[^]*EOF\r\n$/);
  await screenshot('plan');
  const whole = await picture.boundingBox();
  const width = async () => (await picture.boundingBox()).width / whole.width;
  await picture.dblclick();
  assert.ok(Math.abs((await width()) - 3) < 0.01, 'it is enlarged');
  await page.getByRole('button', { name: 'Whole plan' }).click();
  assert.deepEqual(await picture.boundingBox(), whole);
  for (const key of ['+', '+', 'ArrowRight', 'ArrowDown']) await page.keyboard.press(key);
  assert.ok(Math.abs((await width()) - 2.25) < 0.01, 'keys enlarge it');
  const moved = await picture.boundingBox();
  assert.ok(Math.abs(whole.x - moved.x - 0.75 * whole.width) < 2, 'and move it to the right');
  assert.ok(Math.abs(whole.y - moved.y - 0.75 * whole.height) < 2, 'and down');
  await page.getByText('arrows move').waitFor(); // said while the keys are used
  assert.deepEqual(await barriers(page), []);
  await screenshot('plan-keys');
  await page.keyboard.press('Home');
  assert.deepEqual(await picture.boundingBox(), whole);
  await page.keyboard.press('Escape');
  await picture.waitFor({ state: 'detached' });
});

test('on a phone everything is within reach of a thumb', { timeout: scan_ms }, async () => {
  const context = await browser.browser.newContext({
    viewport: { width: 390, height: 844 },
    deviceScaleFactor: 2,
    hasTouch: true,
    isMobile: true,
    colorScheme: 'dark',
  });
  const phone = await openPage(context, `${server.origin}/#token=${server.token}`);
  await phone.page.getByRole('link', { name: title }).click();
  await untilScan(
    phone.page,
    'the surface is shown',
    60_000,
    (state) => state.mesh.state === 'shown',
  );
  await untilResting(phone.page);
  await phone.page.screenshot({ path: path.join(artifacts, 'phone.png') });
  const inReach = async (name) => {
    const box = await phone.page.getByRole('button', { name, exact: true }).boundingBox();
    assert.ok(
      box.x >= 0 && box.x + box.width <= 390,
      `${name} is on the screen: ${JSON.stringify(box)}`,
    );
    assert.ok(box.height >= 44, `${name} is ${box.height} px high`);
  };
  for (const name of ['More', 'Download', 'See inside', 'Show all', 'Measure']) await inReach(name);
  assert.deepEqual(await tooSmall(phone.page), []);
  assert.ok(
    (await phone.page.getByRole('heading', { name: title }).boundingBox()).width > 90,
    'the title has room',
  );
  const panels = await Promise.all(
    ['.status', '.view'].map((name) => phone.page.locator(name).boundingBox()),
  );
  assert.ok(panels[0].height + panels[1].height < 844 / 4, 'the panels leave the picture its room');
  await phone.page.getByRole('button', { name: 'Measure' }).tap();
  await phone.page.locator('.measure-kind').getByText('Area', { exact: true }).tap();
  assert.deepEqual(await tooSmall(phone.page), []);
  const rows = await phone.page
    .locator('.measure-kind label')
    .evaluateAll((all) => new Set(all.map((label) => label.offsetTop)).size);
  assert.equal(rows, 1, 'all kinds of measurements are in one row');
  await phone.page.screenshot({ path: path.join(artifacts, 'phone-measure.png') });
  await phone.page.getByRole('button', { name: 'Close', exact: true }).tap();
  await phone.page.getByRole('button', { name: 'More' }).tap();
  await phone.page.getByRole('button', { name: 'Section', exact: true }).tap();
  await phone.page.getByRole('button', { name: 'Clip box' }).tap();
  await phone.page.locator('.section-kind').getByText('Vertical', { exact: true }).tap();
  await phone.page
    .locator('.section-words')
    .getByText(/of lines/)
    .waitFor();
  assert.deepEqual(await tooSmall(phone.page), []);
  await untilResting(phone.page);
  const section = phone.page.locator('.card.section');
  assert.ok((await section.boundingBox()).height < 844 / 3, 'most of the screen is for the model');
  assert.ok(
    await section.evaluate((node) => node.scrollHeight <= node.clientHeight),
    'and nothing has to be scrolled',
  );
  await phone.page.screenshot({ path: path.join(artifacts, 'phone-section.png') });
  await phone.page.getByRole('button', { name: 'Take out' }).tap();
  await section.getByRole('button', { name: 'Remove floating parts' }).waitFor();
  assert.deepEqual(await tooSmall(phone.page), []);
  await phone.page.getByRole('button', { name: 'Take out' }).tap();
  await phone.page.locator('.section-kind').getByText('No section').tap();
  await phone.page.getByRole('button', { name: 'Clip box' }).tap();
  await phone.page.getByRole('button', { name: 'Close', exact: true }).tap();
  await phone.page.getByRole('button', { name: 'More' }).tap();
  await phone.page.getByRole('button', { name: 'Frames', exact: true }).tap();
  await phone.page.locator('.depth-scale').getByText(/ m$/).first().waitFor();
  await untilResting(phone.page);
  assert.deepEqual(await tooSmall(phone.page), []);
  await phone.page.screenshot({ path: path.join(artifacts, 'phone-frames.png') });
  await phone.page.getByRole('button', { name: 'Close the frames' }).tap();
  await phone.page.getByRole('button', { name: 'More' }).tap();
  assert.deepEqual(await tooSmall(phone.page), []);
  await phone.page.getByRole('button', { name: 'Share', exact: true }).waitFor();
  await phone.page.keyboard.press('Escape');
  await phone.page.getByRole('button', { name: 'More' }).tap();
  await phone.page.getByRole('button', { name: 'Floor plan' }).tap();
  const plan = phone.page.getByRole('img', { name: 'Floor plan of' });
  await plan.waitFor({ timeout: 60_000 });
  const { x, y, width, height } = await plan.boundingBox();
  const fingers = await context.newCDPSession(phone.page);
  for (const [type, apart_px] of [
    ['touchStart', 20],
    ['touchMove', 40],
    ['touchMove', 60],
    ['touchEnd', null],
  ]) {
    const touchPoints =
      apart_px === null
        ? []
        : [-1, 1].map((side, id) => ({
            x: x + width / 2 + side * apart_px,
            y: y + height / 2,
            id,
          }));
    await fingers.send('Input.dispatchTouchEvent', { type, touchPoints });
  }
  await until(
    phone.page,
    'two fingers enlarge the plan',
    (least_px) => document.querySelector('.plan').getBoundingClientRect().width > least_px,
    2.9 * width,
  );
  assert.deepEqual(await tooSmall(phone.page), []);
  await phone.page.getByRole('dialog').getByRole('button', { name: 'Close' }).tap();
  await phone.page.getByRole('button', { name: 'Download', exact: true }).tap();
  await phone.page.getByRole('button', { name: /^GLB, opens/ }).waitFor();
  for (const row of await phone.page.locator('.download-row').all())
    assert.ok((await row.boundingBox()).height >= 44);
  await phone.page.screenshot({ path: path.join(artifacts, 'phone-downloads.png') });
  await phone.page.getByRole('button', { name: 'Close the downloads' }).tap();
  await phone.page.getByRole('link', { name: 'All scans' }).tap();
  await phone.page.getByRole('link', { name: title }).waitFor();
  assert.deepEqual(await tooSmall(phone.page), []);
  assert.deepEqual(phone.complaints, []);
  await context.close();
});

// However many measurements are kept, what else the panel has stays in reach.
async function listOfManyIsBounded(page) {
  const route = `${server.origin}/api/v1/scans/${/scan\/(\w+)/.exec(page.url())[1]}/measurements`;
  const headers = { Authorization: `Bearer ${server.token}`, 'Content-Type': 'application/json' };
  const ask = (path, method, body) =>
    fetch(route + path, { method, headers, body: body && JSON.stringify(body) });
  const [{ kind, points }] = (await (await ask('', 'GET')).json()).measurements;
  const ids = [];
  for (let i = 1; i <= 8; ++i)
    ids.push((await (await ask('', 'POST', { name: `Copy ${i}`, kind, points })).json()).id);
  const again = async () => {
    for (let i = 0; i < 2; ++i) await page.locator('.picture').press('m');
  };
  await again();
  const list = page.getByRole('list', { name: 'Kept measurements' });
  const newest = list.locator('li').filter({ hasText: 'Copy 8' });
  await newest.waitFor();
  const isBounded = async (what) => {
    const [outer, row, last] = await Promise.all(
      [list, newest, page.getByRole('button', { name: 'Close', exact: true })].map((node) =>
        node.boundingBox(),
      ),
    );
    assert.ok(outer.height < 300 && outer.height >= 44, `${what}: ${outer.height} px`);
    assert.ok(row.y + row.height <= outer.y + outer.height + 1, `${what}: the newest is seen`);
    assert.ok(outer.y + outer.height <= last.y, `${what}: and what is below the list`);
    assert.ok(
      await page.locator('.measure').evaluate((node) => node.scrollHeight <= node.clientHeight),
      `${what}: only the list scrolls`,
    );
  };
  await isBounded('on a desk');
  await list.press('Home');
  const isAtStart = (wanted, what) =>
    until(
      page,
      what,
      (yes) => (document.querySelector('.measure-list').scrollTop === 0) === yes,
      wanted,
    );
  await isAtStart(true, 'a key scrolls it');
  assert.deepEqual(await barriers(page), []);
  const size = page.viewportSize();
  await page.setViewportSize({ width: 390, height: 844 });
  await again();
  await list.press('End');
  await isAtStart(false, 'and back');
  await isBounded('on a phone');
  await screenshot('measured-many-phone');
  await page.setViewportSize(size);
  for (const id of ids) await ask(`/${id}`, 'DELETE');
  await again();
  await newest.waitFor({ state: 'detached' });
  await untilResting(page);
}

test('clicks measure distances, planes, angles and areas, which are kept with the scan', {
  timeout: 120_000,
}, async () => {
  const { page } = viewer;
  await page.getByRole('button', { name: 'Show all' }).click();
  await untilResting(page);
  await page.locator('.picture').press('m');
  await page.getByText('Click on two points.').waitFor();
  await page.mouse.click(560, 230); // the wall behind, and the one to the left
  await page.getByText('Click on the second point.').waitFor();
  await page.mouse.click(215, 420);
  const value = page.locator('.measure-newest').getByText(/^\d+\.\d{3} m ± 0\.\d{3} m \(95 %\)$/);
  await value.waitFor();
  const said = await value.textContent();
  await page.getByRole('textbox', { name: 'Name of the measurement' }).fill('Across');
  await page.getByRole('button', { name: 'Keep' }).click();
  await page.locator('.measure-list').getByText(said, { exact: true }).waitFor();
  assert.deepEqual(await barriers(page), []);
  await screenshot('measured');
  await listOfManyIsBounded(page);
  await page.getByRole('button', { name: 'Remove Across' }).click();
  await page.locator('.measure-list').getByText(said).waitFor({ state: 'detached' });

  const newest = page.locator('.measure-newest strong');
  const kind = (name) => page.locator('.measure-kind').getByText(name, { exact: true }).click();
  for (const [name, pattern] of [
    ['Angle', /^\d+\.\d\d° ± \d+\.\d\d° \(95 %\)$/],
    ['Height', /^\d\.\d{3} m ± 0\.\d{3} m \(95 %\)$/],
    ['To a plane', /^\d\.\d{3} m ± 0\.\d{3} m \(95 %\)$/],
  ]) {
    await kind(name);
    await page.mouse.click(215, 420);
    await page.mouse.click(560, 230);
    await newest.getByText(pattern).waitFor();
  }
  await screenshot('measured-plane');
  await kind('Area');
  for (const [x, y] of [
    [560, 180],
    [595, 180],
    [595, 270],
    [575, 275],
  ])
    await page.mouse.click(x, y); // bare wall beside the picture
  await page.getByText('4 corners.').waitFor();
  await page.keyboard.press('Backspace');
  await page.getByText('3 corners.').waitFor();
  await page.mouse.click(580, 275);
  await page.mouse.dblclick(560, 270);
  await newest.getByText(/^\d\.\d{3} m² ± 0\.\d{3} m² \(95 %\)$/).waitFor();
  assert.deepEqual(await barriers(page), []);
  await screenshot('measured-area');
  await page.keyboard.press('Escape');
  await page.getByText('Click for the next one.').waitFor({ state: 'hidden' });
});

test('all frames of a finished scan can be looked back at', { timeout: 60_000 }, async () => {
  const { page } = viewer;
  const facts = page.locator('.frame-facts');
  const slider = page.getByRole('slider', { name: 'Frame' });
  // Of what is drawn: how many different colours, by kind of image.
  const colors = () =>
    page
      .locator('.card.frames:not(.live) canvas.frame-image:not(.missing)')
      .evaluateAll((all) =>
        all.map(
          (canvas) =>
            new Set(
              new Uint32Array(
                canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer,
              ),
            ).size,
        ),
      );
  await page.locator('.picture').press('t');
  await facts.getByText('Frame 0 / 35').waitFor();
  await slider.press('End');
  await facts.getByText('Frame 35 / 35').waitFor();
  await slider.press('ArrowLeft');
  await facts.getByText('Frame 34 / 35').waitFor();
  await facts.getByText('0:02.267').waitFor();
  await facts.getByText('Tracked').waitFor();
  await page
    .locator('.depth-scale')
    .getByText(/^\d\.\d m$/)
    .first()
    .waitFor(); // its images are there
  const [color, depth] = await colors();
  assert.ok(color > 500 && depth > 100, `${color} and ${depth} colours`);
  assert.deepEqual(await barriers(page), []);
  await untilResting(page);
  await screenshot('frames');
  const before = await lookAt(browser.context, page);
  await page.getByRole('button', { name: 'Look through the camera' }).click();
  assert.notEqual((await lookAt(browser.context, page)).hash, before.hash, 'the view has moved');
  await screenshot('looked-through');
  await slider.press('Home');
  await slider.press('Space');
  await facts.getByText(/Frame [1-9]\d* \/ 35/).waitFor();
  await page.getByRole('button', { name: 'Pause' }).click();
  await page.keyboard.press('Escape');
  await facts.waitFor({ state: 'hidden' });
  await page.getByRole('button', { name: 'Show all' }).click();
});

test('the floor is set by a click, keys have a sheet, light follows the system', async () => {
  const { page } = viewer;
  await page.getByRole('button', { name: 'Show all' }).click();
  const before = await lookAt(browser.context, page);
  await page.mouse.dblclick(400, 360); // left of the middle, where something is
  assert.notEqual(
    (await lookAt(browser.context, page)).hash,
    before.hash,
    'that is the middle now',
  );
  await page.getByRole('button', { name: 'Show all' }).click();
  await page.getByRole('button', { name: 'More' }).click();
  await page.getByRole('button', { name: 'Set the floor' }).click();
  await page.mouse.click(560, 200); // on a wall
  await page.getByText('Click on the floor').waitFor({ state: 'hidden' });
  assert.notEqual((await lookAt(browser.context, page)).hash, before.hash, 'the room has turned');
  const kept = await page.evaluate(() => JSON.parse(localStorage.getItem('hermite.up')));
  assert.ok(Math.abs(kept[0][1][1]) < 0.5, `a wall is no floor: ${kept}`);
  await page.getByRole('button', { name: 'More' }).click();
  await page.getByRole('button', { name: 'Find the floor again' }).click();
  assert.equal(await page.evaluate(() => localStorage.getItem('hermite.up')), '[]');
  assert.deepEqual(await barriers(page), []);
  await page.emulateMedia({ colorScheme: 'light' });
  const light = await lookAt(browser.context, page);
  assert.ok(light.brightShare > 0.95, `the ground is light: ${light.brightShare}`);
  await screenshot('light');
  await page.keyboard.press('?');
  await page.getByRole('heading', { name: 'Mouse, touch and keyboard' }).waitFor();
  await page.keyboard.press('Escape');
  await page.getByRole('dialog').waitFor({ state: 'detached' });
  await page.emulateMedia({ colorScheme: 'dark' });
});

test('a clip box is dragged, and a section is taken away as a drawing', {
  timeout: 60_000,
}, async () => {
  const { page } = viewer;
  await page.getByRole('button', { name: 'Show all' }).click();
  await page.locator('.picture').press('x');
  await page.getByRole('button', { name: 'Clip box' }).click();
  await page.locator('.section-kind').getByText('Horizontal').click();
  const notice = page.locator('.section-words');
  const length = async () => Number.parseFloat(await notice.textContent());
  await notice.getByText(/^\d+\.\d\d m of lines in \d+ pieces\.$/).waitFor();
  const [whole, before] = [await length(), await lookAt(browser.context, page)];
  const newBox = (what, known) =>
    until(
      page,
      what,
      (old) => [/&clip=[^&]+/.exec(location.hash)?.[0]].find((box) => box !== old),
      known,
    );
  const first = await newBox('the address has the box');
  const handles = await handlesOf(page);
  assert.ok(handles.length > 0, 'a handle is in the middle of the picture');
  await page.mouse.move(...handles[0]);
  await page.mouse.down();
  for (const share of [0.3, 0.6])
    await page.mouse.move(
      handles[0][0] + share * (560 - handles[0][0]),
      handles[0][1] + share * (300 - handles[0][1]),
    );
  await page.mouse.up();
  await newBox('the address has a smaller box', first); // perhaps one from the midst of the drag
  assert.notEqual(
    (await lookAt(browser.context, page)).hash,
    before.hash,
    'what is outside of the box is gone',
  );
  assert.ok((await length()) <= whole, 'also from the section');
  await screenshot('section');
  const take = async (name) => {
    const download = page.waitForEvent('download');
    await page.getByRole('button', { name, exact: true }).click();
    const file = await download;
    assert.match(
      file.suggestedFilename(),
      new RegExp(`^Synthetic_room-section_horizontal_1\\.\\d+m\\.${name.toLowerCase()}$`),
    );
    return readFile(await file.path(), 'utf8');
  };
  const svg = await take('SVG');
  const drawn = await page.evaluate((text) => {
    const read = new DOMParser().parseFromString(text, 'image/svg+xml');
    return {
      broken: read.querySelectorAll('parsererror').length,
      lines: read.querySelectorAll('#section path').length,
    };
  }, svg);
  assert.equal(drawn.broken, 0);
  assert.ok(drawn.lines > 0);
  const dxf = (await take('DXF')).split('\r\n');
  assert.equal(
    dxf.filter((line) => ['LINE', 'POLYLINE'].includes(line)).length,
    drawn.lines,
    'as many lines are in both',
  );
  assert.deepEqual(await barriers(page), []);
  const address = await page.evaluate(() => location.hash);
  await page.keyboard.press('Escape');
  assert.equal(
    await page.evaluate(() => location.hash),
    address,
    'the box stays when the tool is closed',
  );
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
  await untilScan(
    guest,
    'the shared scan with its surface',
    60_000,
    (scan) => scan.snapshotComplete && scan.points > 0 && scan.mesh.state === 'shown',
  );
  assert.ok(!guest.url().includes('hms_'), 'the secret leaves the address');
  assert.equal(guest.url(), page.url(), 'the clip box and the section are shared with it');
  assert.equal(await guest.getByRole('button', { name: 'Share' }).count(), 0);
  assert.equal(
    await guest.getByRole('button', { name: 'Frames' }).count(),
    0,
    'a link shows the model and not what the camera has seen',
  );
  await guest.goto(`${server.origin}/#/`);
  await guest.getByRole('link', { name: title }).waitFor();
  assert.equal(await guest.locator('.scan-row').count(), 1);
  assert.equal(
    await guest.getByText('Add a recording').isVisible(),
    false,
    'what would be refused is not offered',
  );
  assert.equal(await guest.getByRole('button', { name: 'Actions for' }).count(), 0);
  await context.close();
  await page.locator('.picture').press('x');
  await page.getByRole('button', { name: 'Clip box' }).click();
  await page.locator('.section-kind').getByText('No section').click();
  await page.keyboard.press('Escape');
});

test('parts are taken out of a scan, and brought back', { timeout: scan_ms }, async () => {
  const { page } = viewer;
  const { mesh: whole } = await scanOf(page);
  const panel = page.getByRole('region', { name: 'Section' });
  await page.locator('.picture').press('x');
  await panel.getByText('Nothing was taken out.').waitFor();
  assert.equal(
    await panel.getByRole('button', { name: 'Keep the inside' }).isVisible(),
    false,
    'there is no box yet',
  );
  await panel.getByRole('button', { name: 'Clip box' }).click();
  const [from] = await handlesOf(page);
  await page.mouse.move(...from);
  await page.mouse.down();
  for (const share of [0.2, 0.5])
    await page.mouse.move(from[0] + share * (560 - from[0]), from[1] + share * (300 - from[1]));
  await page.mouse.up();
  const before = await lookAt(browser.context, page);
  await panel.getByRole('button', { name: 'Remove the inside' }).click();
  await panel.getByText('One edit has taken something out.').waitFor();
  assert.equal(
    await panel.getByRole('button', { name: 'Reset' }).isVisible(),
    false,
    'the box has done its work',
  );
  assert.notEqual(
    (await lookAt(browser.context, page)).hash,
    before.hash,
    'what was in the box is gone',
  );
  await untilScan(
    page,
    'a surface without it',
    120_000,
    ({ mesh }) => mesh.state === 'shown' && mesh.triangles < whole.triangles,
  );
  await screenshot('edits');
  assert.deepEqual(await barriers(page), []);
  await panel.getByRole('button', { name: 'Remove floating parts' }).click();
  await panel.getByText('2 edits have taken something out.').waitFor();
  for (const left of ['One edit has taken something out.', 'Nothing was taken out.']) {
    await panel.getByRole('button', { name: 'Undo' }).click();
    await panel.getByText(left).waitFor();
  }
  await untilScan(
    page,
    'the whole surface',
    120_000,
    ({ mesh }) => mesh.state === 'shown' && mesh.triangles === whole.triangles,
  );
  assert.equal(await panel.getByRole('button', { name: 'Redo' }).isEnabled(), true);
  await page.keyboard.press('Escape');
});

test('a finished scan looks the same when opened again, also from a restarted server', async () => {
  const { page } = viewer;
  const before = await scanOf(page);
  const again = async (what) => {
    const scan = await untilScan(
      page,
      what,
      60_000,
      (state) => state.snapshotComplete && state.phase === 'finished',
    );
    assert.equal(scan.points, before.points, what);
    assert.equal(scan.chunks, before.chunks, what);
    assert.ok(scan.poses > 0, 'the trajectory is there');
    assert.equal(scan.submaps, before.submaps, what);
    assert.equal(scan.keyframes, before.keyframes, what);
  };
  await page.reload();
  await again('loaded again');
  viewer.outage.on = true;
  await server.stop();
  server = await startServer(folder, server.port);
  await page.reload();
  await again('loaded from the restarted server');
  viewer.outage.on = false;
});

test('a page comes back by itself when the server does', { timeout: scan_ms }, async () => {
  const { page, outage } = viewer;
  const client = stream({ sequence: endless, title: 'Long scan', rate: slowly });
  await page.goto(`${server.origin}/#/`);
  await page.getByRole('link', { name: 'Long scan' }).click();
  // Enough frames for a surface without the last ones, which may not be on the disk yet.
  await untilScan(
    page,
    'the surface of the long scan',
    120_000,
    (scan) => scan.triangles > 0 && scan.framesProcessed > 10,
  );

  outage.on = true;
  // Told to stop, it would have sent everything and said that the scan has ended.
  await server.kill();
  client.stop();
  await untilScan(
    page,
    'the page says that it waits',
    30_000,
    (scan) => scan.connection === 'waiting',
  );
  await screenshot('server_gone');
  // What is seen stays until there is something better. The server builds the scan again, and does
  // not wait long for a camera that is dead.
  server = await startServer(folder, server.port, ['--resume-window', '1']);
  let least = Infinity;
  await untilScan(page, 'the page is back', 120_000, (scan) => {
    least = Math.min(least, scan.points + scan.triangles);
    return scan.snapshotComplete && scan.phase === 'interrupted';
  });
  assert.ok(least > 0, 'the picture was never empty');
  outage.on = false;
  await page.getByText('Interrupted').first().waitFor();
});

test('a scan is stopped, renamed, found, and deleted with a way back', {
  timeout: scan_ms,
}, async () => {
  const { page } = viewer;
  stream({ sequence: endless, title: 'To be stopped', rate: slowly });
  await page.goto(`${server.origin}/#/`);
  await page.getByRole('link', { name: 'To be stopped' }).click();
  await untilScan(
    page,
    'the scan runs',
    60_000,
    (scan) => scan.phase === 'running' && scan.framesProcessed > 5,
  );
  await page.getByRole('button', { name: 'More' }).click();
  await page.getByRole('button', { name: 'Pause the scan' }).click();
  const paused = await untilScan(page, 'the scan is paused', 60_000, (scan) => scan.paused);
  assert.equal(paused.phaseText, 'paused by its camera');
  await page.getByText('Paused', { exact: true }).first().waitFor();
  await page.getByRole('button', { name: 'More' }).click();
  await page.getByRole('button', { name: 'Go on scanning' }).click();
  await untilScan(
    page,
    'the scan goes on',
    60_000,
    (scan) => !scan.paused && scan.framesReceived > paused.framesReceived,
  );
  await page.getByRole('button', { name: 'More' }).click();
  await page.getByRole('button', { name: 'Stop and keep' }).click();
  const stopped = await untilScan(
    page,
    'the scan is stopped',
    60_000,
    (scan) => scan.phase === 'interrupted' && scan.connection === 'closed',
  );
  assert.equal(stopped.phaseText, 'stopped from the viewer');

  await page.getByRole('button', { name: 'More' }).click();
  await page.getByRole('button', { name: 'Rename' }).click();
  await page.getByLabel('Title of the scan').fill('Corridor');
  await page.getByRole('dialog').getByRole('button', { name: 'Rename' }).click();
  await page.getByRole('heading', { name: 'Corridor' }).waitFor();
  await page.getByRole('button', { name: 'More' }).click();
  await page.getByRole('button', { name: 'Tags' }).click();
  await page.getByLabel('Tags, with commas between them').fill('house 9, attic');
  await page.getByRole('dialog').getByRole('button', { name: 'Save' }).click();
  const tags = page.locator('.status .tag');
  await tags.nth(1).waitFor();
  assert.deepEqual(await tags.allTextContents(), ['attic', 'house 9'], 'as the server sorts them');
  await page.reload();
  await tags.nth(1).waitFor();
  assert.deepEqual(await tags.allTextContents(), ['attic', 'house 9'], 'they are kept');
  assert.deepEqual(await barriers(page), []);
  await screenshot('tags');
  await page.getByRole('link', { name: 'All scans' }).click();
  await page.getByRole('link', { name: 'Corridor' }).waitFor();
  assert.deepEqual(await barriers(page), []);
  await page.getByLabel('Search the titles of scans').fill('CORR');
  await page.getByRole('link', { name: title }).waitFor({ state: 'detached' });
  await screenshot('found');

  await page.getByLabel('Search the titles of scans').fill('');
  await page.getByRole('button', { name: 'Actions for Corridor' }).click();
  await page.getByRole('button', { name: 'Tags' }).click();
  await page.getByLabel('Tags, with commas between them').fill(`${'x'.repeat(51)}`);
  await page.getByRole('dialog').getByRole('button', { name: 'Save' }).click();
  await page.getByText('is longer than 50 bytes').waitFor();
  await page.getByLabel('Tags, with commas between them').fill('house 9, corridor,house 9');
  await page.getByRole('dialog').getByRole('button', { name: 'Save' }).click();
  await page.getByRole('button', { name: 'house 9' }).click();
  await page.getByRole('link', { name: title }).waitFor({ state: 'detached' });
  await page.getByRole('link', { name: 'Corridor' }).waitFor();
  assert.deepEqual(await barriers(page), []);
  await screenshot('tagged');
  await page.getByRole('button', { name: 'house 9' }).click();
  await page.getByRole('link', { name: title }).waitFor();

  const away = async () => {
    await page.getByRole('button', { name: 'Actions for Corridor' }).click();
    await page.getByRole('button', { name: 'Delete' }).click();
    await page.getByText('“Corridor” is deleted.').waitFor();
    assert.equal(await page.getByRole('link', { name: 'Corridor' }).count(), 0);
  };
  await away();
  await page.getByRole('button', { name: 'Undo' }).click();
  await page.getByRole('link', { name: 'Corridor' }).waitFor();
  await away();
  await page.reload(); // whoever leaves has not taken it back
  await page.getByRole('link', { name: title }).waitFor();
  assert.equal(await page.getByRole('link', { name: 'Corridor' }).count(), 0);
});

test('a scan that does not exist is said to be so', async () => {
  const { page } = viewer;
  await page.goto(`${server.origin}/#/scan/${'a'.repeat(26)}`);
  await page.getByText('This scan does not exist, or no longer.').waitFor();
});

test('nothing went wrong in the browser', () => {
  assert.deepEqual(viewer.complaints, []);
});
