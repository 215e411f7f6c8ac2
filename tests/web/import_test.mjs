// Files of other programs, dropped into the list of the real server in a real browser: a mesh is
// seen as its surface, a cloud as points; and in a page of another site.
//
//   node --test tests/web/import_test.mjs
//
// HERMITE_BUILD: where the programs are (build/release). HERMITE_ARTIFACTS: where images go.
import assert from 'node:assert/strict';
import { createServer } from 'node:http';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { lookAt, openServerAndBrowser, openPage, until, untilScan } from './browser.mjs';

const limit_ms = 60_000;
let setup, artifacts, server, browser, viewer, site;

before(async () => {
  site = await openSite();
  setup = await openServerAndBrowser('import', ['--embed-in', site.origin]);
  ({ server, browser, artifacts } = setup);
  viewer = await openPage(browser.context, `${server.origin}/#token=${server.token}`);
});

after(async () => {
  site?.close();
  await setup?.close();
});

// Another site, whose one page has whatever it is given.
async function openSite() {
  const opened = { html: '' };
  const server = createServer((_, response) =>
    response
      .setHeader('Content-Type', 'text/html; charset=utf-8')
      .end(`<!doctype html>${opened.html}`),
  );
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  opened.origin = `http://localhost:${server.address().port}`;
  opened.close = () => server.close();
  return opened;
}

// A house: four walls in colours of their materials and a roof of another, y up, 4 m wide; each
// corner of a face is a vertex.
function houseGlb() {
  const faces = [
    [[1, 0.2, 0.1], [[-2, 0, 2], [2, 0, 2], [2, 3, 2], [-2, 3, 2]]],
    [[0.1, 0.5, 1], [[2, 0, 2], [2, 0, -2], [2, 3, -2], [2, 3, 2]]],
    [[0.2, 0.8, 0.2], [[2, 0, -2], [-2, 0, -2], [-2, 3, -2], [2, 3, -2]]],
    [[1, 0.8, 0.1], [[-2, 0, -2], [-2, 0, 2], [-2, 3, 2], [-2, 3, -2]]],
    [[0.7, 0.1, 0.6], [[-2, 3, 2], [2, 3, 2], [2, 5, 0], [-2, 5, 0]]],
    [[0.7, 0.1, 0.6], [[2, 3, -2], [-2, 3, -2], [-2, 5, 0], [2, 5, 0]]],
  ];
  const positions = Float32Array.from(faces.flatMap(([, corners]) => corners.flat()));
  const indices = Uint16Array.of(0, 1, 2, 0, 2, 3);
  const binary = Buffer.concat([Buffer.from(positions.buffer), Buffer.from(indices.buffer)]);
  const json = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [
      {
        primitives: faces.map((_, i) => ({
          attributes: { POSITION: i },
          indices: faces.length,
          material: i,
        })),
      },
    ],
    materials: faces.map(([color]) => ({
      pbrMetallicRoughness: { baseColorFactor: [...color, 1] },
    })),
    buffers: [{ byteLength: binary.length }],
    bufferViews: [
      { buffer: 0, byteLength: positions.byteLength },
      { buffer: 0, byteOffset: positions.byteLength, byteLength: indices.byteLength },
    ],
    accessors: [
      ...faces.map(([, corners], i) => ({
        bufferView: 0,
        byteOffset: 48 * i,
        componentType: 5126,
        type: 'VEC3',
        count: 4,
        min: low(corners),
        max: high(corners),
      })),
      { bufferView: 1, componentType: 5123, type: 'SCALAR', count: 6 },
    ],
  };
  const text = Buffer.from(
    JSON.stringify(json).padEnd(Math.ceil(JSON.stringify(json).length / 4) * 4),
  );
  const header = (length, kind) =>
    Buffer.concat([Buffer.from(Uint32Array.of(length).buffer), Buffer.from(kind)]);
  const chunks = Buffer.concat([
    header(text.length, 'JSON'),
    text,
    header(binary.length, 'BIN\0'),
    binary,
  ]);
  return Buffer.concat([
    Buffer.from('glTF'),
    Buffer.from(Uint32Array.of(2, 12 + chunks.length).buffer),
    chunks,
  ]);
}
const low = (corners) =>
  [0, 1, 2].map((axis) => Math.min(...corners.map((corner) => corner[axis])));
const high = (corners) =>
  [0, 1, 2].map((axis) => Math.max(...corners.map((corner) => corner[axis])));

// A street of a map projection, 60 m long: the ground in green, a wall in
// red, z up, without normals.
function streetPly() {
  const rows = [];
  for (let x = 0; x < 60; x += 0.4)
    for (let y = 0; y < 20; y += 0.4) rows.push(`${500000 + x} ${4649776 + y} 30 40 160 60`);
  for (let x = 0; x < 60; x += 0.4)
    for (let z = 0; z < 8; z += 0.4) rows.push(`${500000 + x} ${4649796} ${30 + z} 200 60 50`);
  const columns = ['double x', 'double y', 'double z', 'uchar red', 'uchar green', 'uchar blue'];
  const properties = columns.map((name) => `property ${name}\n`).join('');
  return Buffer.from(
    `ply\nformat ascii 1.0\nelement vertex ${rows.length}\n` +
      `${properties}end_header\n${rows.join('\n')}\n`,
  );
}

// As from a folder beside the browser: not through the hidden input.
async function drop(name, bytes) {
  const transfer = await viewer.page.evaluateHandle(
    ([base64, title]) => {
      const files = new DataTransfer();
      files.items.add(
        new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], title),
      );
      return files;
    },
    [bytes.toString('base64'), name],
  );
  await viewer.page.dispatchEvent('main', 'drop', { dataTransfer: transfer });
}

// The page of the viewer in another one.
async function embeddedIn(page) {
  const element = await page.locator('iframe').first().elementHandle({ timeout: limit_ms });
  return element.contentFrame();
}

async function open(title) {
  await viewer.page
    .getByRole('link', { name: new RegExp(title) })
    .first()
    .click({ timeout: limit_ms });
}

test('a mesh that is dropped into the list is a scan with its surface', {
  timeout: 3 * limit_ms,
}, async () => {
  const { page } = viewer;
  await page.getByText('No scans yet.').waitFor();
  await drop('House.glb', houseGlb());
  await page.getByText('Imported').waitFor({ timeout: limit_ms });
  await open('House');
  const scan = await untilScan(
    page,
    'the surface is shown',
    limit_ms,
    ({ mesh }) => mesh.state === 'shown',
  );
  assert.equal(scan.mesh.triangles, 12);
  const { brightShare, colors } = await lookAt(browser.context, page);
  assert.ok(
    brightShare > 0.05 && colors > 100,
    `a house fills some of the picture: ${brightShare}, ${colors} colours`,
  );
  await page.screenshot({ path: path.join(artifacts, 'imported-mesh.png') });
  await page.getByRole('button', { name: 'Download' }).click();
  await page.getByText('GLB, as it was imported').waitFor();
  assert.equal(
    await page.getByText('LAS').count(),
    0,
    'what cannot be made of a mesh is not offered',
  );
  await page.screenshot({ path: path.join(artifacts, 'imported-downloads.png') });
});

test('a cloud that is dropped into the list is a scan of points, far off and large as it is', {
  timeout: 3 * limit_ms,
}, async () => {
  const { page } = viewer;
  await page.evaluate(() => (location.hash = '#/'));
  await page.getByRole('heading', { name: 'Scans' }).waitFor();
  await drop('Street.ply', streetPly());
  await page.getByText('Street').first().waitFor({ timeout: limit_ms });
  await page.locator('.scan-row').nth(1).waitFor({ timeout: limit_ms });
  await until(
    page,
    'both have an image',
    () => document.querySelectorAll('.thumbnail.there').length === 2,
  );
  await page.screenshot({ path: path.join(artifacts, 'imported-list.png') });
  await page.setViewportSize({ width: 390, height: 844 });
  await page.screenshot({ path: path.join(artifacts, 'imported-list-phone.png') });
  await page.setViewportSize({ width: 1024, height: 640 });
  await open('Street');
  await untilScan(
    page,
    'the points are there, and that there is no surface is said',
    limit_ms,
    ({ points, mesh }) => points > 10_000 && mesh.state === 'failed',
  );
  await page.getByText('its points have no normals').waitFor();
  const { brightShare } = await lookAt(browser.context, page);
  assert.ok(brightShare > 0.05, `a street fills some of the picture: ${brightShare}`);
  await page.screenshot({ path: path.join(artifacts, 'imported-cloud.png') });
});

test('a page of a site that the operator has named shows a scan without the tools', {
  timeout: 3 * limit_ms,
}, async () => {
  const { page } = viewer;
  await page.getByRole('button', { name: 'More' }).click();
  await page.getByRole('button', { name: 'Tags' }).click();
  await page.getByLabel('Tags, with commas between them').fill('outside');
  await page.getByRole('dialog').getByRole('button', { name: 'Save' }).click();
  await page.locator('.status').getByText('outside', { exact: true }).waitFor();
  await page.getByRole('button', { name: 'More' }).click();
  await page.getByRole('button', { name: 'Embed in a page' }).click();
  const sources = page.locator('.embedding textarea');
  await until(page, 'the HTML is there', () =>
    [...document.querySelectorAll('.embedding textarea')].every((area) => area.value !== ''),
  );
  await page.screenshot({ path: path.join(artifacts, 'embed-dialog.png') });
  const [frame, element] = [await sources.nth(0).inputValue(), await sources.nth(1).inputValue()];
  await page.getByRole('button', { name: 'Close', exact: true }).last().click();
  for (const [name, html] of Object.entries({ frame, element })) {
    site.html = `<title>Another site</title><h1>Our street</h1>${html}`;
    const other = await openPage(browser.context, site.origin);
    const inside = await embeddedIn(other.page);
    await untilScan(inside, 'the points are there', limit_ms, ({ points }) => points > 10_000);
    assert.equal(
      await inside.locator('.title-bar, .card, button').filter({ visible: true }).count(),
      0,
      'no tools',
    );
    const link = await inside.getByRole('link', { name: /Street/ }).getAttribute('href');
    await inside.locator('.tag').getByText('outside').waitFor();
    await other.page.screenshot({ path: path.join(artifacts, `embedded-${name}.png`) });
    assert.deepEqual(other.complaints, []);
    await other.page.goto(new URL(link, server.origin).href);
    await other.page.getByRole('heading', { name: 'Street' }).waitFor({ timeout: limit_ms });
    await other.page.locator('.status .tag').getByText('outside').waitFor();
    await other.page.getByRole('button', { name: 'More' }).click();
    await other.page.getByRole('button', { name: 'Mouse and keyboard' }).waitFor();
    assert.equal(await other.page.getByRole('button', { name: 'Tags' }).count(), 0);
    await other.page.close();
  }
});

test('a page of any other site shows none', { timeout: limit_ms }, async () => {
  const page = await browser.context.newPage();
  const refused = new Promise((resolve) =>
    page.on('console', (message) => message.text().includes('frame-ancestors') && resolve()),
  );
  await page.goto(site.origin.replace('localhost', '127.0.0.1'));
  await page.evaluate(
    (url) => document.body.append(Object.assign(document.createElement('iframe'), { src: url })),
    server.origin,
  );
  await refused;
  await page.close();
});

test('names and addresses that are script are text', { timeout: 3 * limit_ms }, async () => {
  const { page } = viewer;
  const dialogs = [];
  page.on('dialog', async (dialog) => {
    dialogs.push(dialog.message());
    await dialog.dismiss();
  });
  const attack = 'alert(document.domain);window.hacked=1';
  const names = [
    `<img src=x onerror="${attack}">`,
    `"><svg onload='${attack}'>`,
    `<script>${attack}<\u2215script>`,
  ];
  const put = async (name, bytes) => {
    const headers = { Authorization: `Bearer ${server.token}` };
    const answer = await fetch(`${server.origin}/api/v1/uploads/${encodeURIComponent(name)}`, {
      method: 'PUT',
      headers,
      body: bytes,
    });
    assert.equal(answer.status, 201);
  };
  await page.evaluate(() => (location.hash = '#/'));
  // The name is in the message of its failure, too.
  for (const name of names) await put(name, Buffer.from('no recording'));
  await put(`${names[0]}.ply`, streetPly());
  for (const name of names) await page.getByText(name).first().waitFor({ timeout: limit_ms });
  await page.getByRole('link', { name: names[0] }).first().click({ timeout: limit_ms });
  await untilScan(
    page,
    'a scan with such a title is shown',
    limit_ms,
    ({ points }) => points > 10_000,
  );
  await page.getByText(names[0]).first().waitFor();
  await page.screenshot({ path: path.join(artifacts, 'script-title.png') });
  await page.getByRole('button', { name: 'Download' }).click();
  for (const hash of [
    `#/scan/${names[0]}`,
    `#/scan/${encodeURIComponent(names[1])}`,
    `#/${names[2]}`,
    `#token=${names[0]}`,
  ]) {
    await page.evaluate((to) => (location.hash = to), hash);
    await page.waitForTimeout(300);
  }
  assert.equal(await page.evaluate(() => window.hacked), undefined);
  assert.deepEqual(dialogs, []);
  assert.equal(await page.locator('img[src=x], svg[onload]').count(), 0);
  await page.goto(`${server.origin}/#token=${server.token}`);
  viewer.complaints.splice(
    0,
    viewer.complaints.length,
    ...viewer.complaints.filter((message) => message.startsWith('policy')),
  );
});

test('what is wrong is said on the page', { timeout: 2 * limit_ms }, async () => {
  const { page, complaints } = viewer;
  await page.evaluate(() => (location.hash = '#/'));
  await page.getByRole('heading', { name: 'Scans' }).waitFor();
  await drop('broken.glb', houseGlb().subarray(0, 300));
  await page
    .getByText(/GLB: it says that it has \d+ bytes, there are 300/)
    .waitFor({ timeout: limit_ms });
  assert.deepEqual(complaints, []);
});
