// Two scans compared in a real browser: a corner of a room in which a box was pushed, another
// place, and what goes wrong.
//
//   node --test tests/web/compare_test.mjs
//
// HERMITE_BUILD: where the programs are (build/release). HERMITE_ARTIFACTS: where images go.
import assert from 'node:assert/strict';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { barriers, openPage, openServerAndBrowser, tooSmall, until } from './browser.mjs';

const limit_ms = 3 * 60_000; // where others keep the machine busy, pages take long
let opened, artifacts, server, browser, viewer, headers;
const scans = {};

// Points of rectangles with their normals and colours, 12 mm apart; points
// inside of boxes are left out.
function corner(boxes) {
  const rows = [];
  const cross = (a, b) => [
    a[1] * b[2] - a[2] * b[1],
    a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0],
  ];
  const hidden = (at) =>
    boxes.some(({ low, high }) =>
      at.every((value, axis) => value > low[axis] - 0.01 && value < high[axis] - 1e-6),
    );
  const add = (from, u, v, color, isWall) => {
    const normal = cross(u, v);
    const length = Math.hypot(...normal);
    const [columns, lines] = [u, v].map((edge) => Math.round(Math.hypot(...edge) / 0.012));
    for (let i = 0; i < columns; ++i)
      for (let j = 0; j < lines; ++j) {
        const at = from.map(
          (value, axis) => value + ((i + 0.5) / columns) * u[axis] + ((j + 0.5) / lines) * v[axis],
        );
        if (!isWall || !hidden(at)) rows.push([at, normal.map((value) => value / length), color]);
      }
  };
  add([0, 0, 0], [1.2, 0, 0], [0, 0.9, 0], [150, 120, 90], true);
  add([1.2, 0, 0], [-1.2, 0, 0], [0, 0, 0.6], [220, 220, 215], true);
  add([0, 0, 0], [0, 0.9, 0], [0, 0, 0.6], [120, 150, 170], true);
  for (const { low, high, color } of boxes) {
    const [x, y, z] = [0, 1, 2].map((axis) =>
      high.map((value, i) => (i === axis ? value - low[i] : 0)),
    );
    const plus = (...vectors) =>
      low.map((value, axis) => vectors.reduce((sum, vector) => sum + vector[axis], value));
    const minus = (vector) => vector.map((value) => -value);
    add(plus(z), x, y, color);
    add(low, x, z, color);
    add(plus(x), y, z, color);
    add(plus(x, y), minus(x), z, color);
    add(plus(y), minus(y), z, color);
  }
  return ply(rows);
}

function ply(rows) {
  const names =
    ['x', 'y', 'z', 'nx', 'ny', 'nz'].map((name) => `property float ${name}\n`).join('') +
    ['red', 'green', 'blue'].map((name) => `property uchar ${name}\n`).join('');
  const points = Buffer.alloc(27 * rows.length);
  rows.forEach(([at, normal, color], i) => {
    [...at, ...normal].forEach((value, k) => points.writeFloatLE(value, 27 * i + 4 * k));
    color.forEach((value, k) => points.writeUInt8(value, 27 * i + 24 + k));
  });
  return Buffer.concat([
    Buffer.from(
      `ply\nformat binary_little_endian 1.0\nelement vertex ${rows.length}\n${names}end_header\n`,
    ),
    points,
  ]);
}

function ball() {
  const rows = [];
  for (let i = 0; i < 4000; ++i) {
    const [turn, z] = [2.39996 * i, 1 - (2 * (i + 0.5)) / 4000];
    const normal = [
      Math.sqrt(1 - z * z) * Math.cos(turn),
      Math.sqrt(1 - z * z) * Math.sin(turn),
      z,
    ];
    rows.push([normal.map((value) => 0.4 * value), normal, [200, 80, 80]]);
  }
  return ply(rows);
}

const usual = [
  { low: [0.15, 0.1, 0], high: [0.4, 0.3, 0.22], color: [200, 60, 50] },
  { low: [0.7, 0.12, 0], high: [0.86, 0.4, 0.35], color: [60, 160, 70] },
  { low: [0.3, 0.55, 0], high: [0.48, 0.7, 0.12], color: [60, 80, 190] },
  { low: [0.85, 0.6, 0], high: [1, 0.72, 0.18], color: [190, 180, 60] },
];
const pushed = usual.map((box, i) =>
  i === 0 ? { ...box, low: [0.17, 0.1, 0], high: [0.42, 0.3, 0.22] } : box,
);

async function importScan(name, bytes) {
  const put = await fetch(`${server.origin}/api/v1/uploads/${name}.ply`, {
    method: 'PUT',
    headers,
    body: bytes,
  });
  const { job } = await put.json();
  for (
    const end_ms = Date.now() + limit_ms;
    Date.now() < end_ms;
    await new Promise((resolve) => setTimeout(resolve, 100))
  ) {
    const { state, scan, words } = await (
      await fetch(`${server.origin}/api/v1/jobs/${job}`, { headers })
    ).json();
    if (state === 'finished') return scan;
    assert.ok(state === 'queued' || state === 'running', `${name} is ${state}: ${words}`);
  }
  assert.fail(`${name} is not imported`);
}

before(async () => {
  opened = await openServerAndBrowser('compare', ['--mesh-on-demand']);
  ({ artifacts, server, browser } = opened);
  headers = { Authorization: `Bearer ${server.token}` };
  for (const [name, bytes] of [
    ['Before', corner(usual)],
    ['After', corner(pushed)],
    ['Ball', ball()],
    ['Point', ply([[[0, 0, 0], [0, 0, 1], [9, 9, 9]]])],
  ])
    scans[name] = await importScan(name, bytes);
  browser.context.setDefaultTimeout(limit_ms);
  viewer = await openPage(
    browser.context,
    `${server.origin}/#token=${server.token}&scan=${scans.After}`,
  );
});

after(() => opened?.close());

const screenshot = async (page, name) =>
  page.screenshot({ path: path.join(artifacts, `${name}.png`) });
const shown = (page) =>
  until(
    page,
    'both scans are in the picture',
    () => window.hermite.drawCalls() > 1 && window.hermite.isResting(),
    undefined,
    limit_ms,
  );
const compare = (first, second) => `${server.origin}/#/scan/${first}?page=compare&with=${second}`;

test('somebody chooses another scan, and sees what has changed since the older one', {
  timeout: limit_ms,
}, async () => {
  const { page } = viewer;
  await page.getByRole('button', { name: 'Share' }).waitFor(); // what the token allows is known
  await page.getByRole('button', { name: 'More' }).click();
  await page.getByRole('button', { name: 'Compare with …' }).click();
  await page.getByRole('searchbox').fill('bef');
  await page.getByRole('button', { name: /^Before/ }).click();
  await page.getByText(/changes? on \d\.\d m² that both scans saw/).waitFor();
  await page.getByRole('heading', { name: 'Before → After' }).waitFor();
  assert.match(page.url(), new RegExp(`scan/${scans.Before}\\?page=compare&with=${scans.After}`));
  await shown(page);
  assert.ok(
    await page
      .getByRole('group', { name: 'What the colours mean' })
      .getByText('50 mm nearer')
      .isVisible(),
  );
  const regions = await page.locator('.compare-region').allTextContents();
  assert.ok(
    regions.some((text) => /^Nearer(19|20|21)\.\d mm ± \d+\.\d mm, \d+ cm²$/.test(text)),
    regions.join('\n'),
  );
  assert.ok(
    regions.some((text) => /^Farther away(19|20|21)\.\d mm/.test(text)),
    regions.join('\n'),
  );
  assert.deepEqual(await barriers(page), []);
});

test('a region is flown to, and both scans stand side by side under one camera', {
  timeout: limit_ms,
}, async () => {
  const { page } = viewer;
  await page.setViewportSize({ width: 1440, height: 900 });
  await shown(page);
  await screenshot(page, 'compare');
  const whole = await page.locator('.compare-stage').screenshot();
  await page.locator('.compare-region').first().press('Enter');
  assert.equal(await page.locator('.compare-region').first().getAttribute('aria-pressed'), 'true');
  await shown(page);
  await screenshot(page, 'compare-region');
  assert.notDeepEqual(await page.locator('.compare-stage').screenshot(), whole);
  await page.keyboard.press('b');
  await page.locator('.compare-name').getByText('Before').waitFor();
  assert.ok(await page.getByLabel('Side by side').isChecked());
  await page.keyboard.press('f');
  await shown(page);
  await screenshot(page, 'compare-sides');
  await page.setViewportSize({ width: 390, height: 844 });
  await shown(page);
  assert.deepEqual(await tooSmall(page), []);
  await screenshot(page, 'compare-sides-phone');
  await page.getByText('One over the other').click();
  await shown(page);
  assert.deepEqual(await barriers(page), []);
  await screenshot(page, 'compare-phone');
  await page.setViewportSize({ width: 1024, height: 640 });
});

test('what cannot be shown is said', { timeout: limit_ms }, async () => {
  const { page } = viewer;
  await page.goto(compare(scans.Before, scans.Ball));
  await page.getByText('These scans do not show the same place').waitFor();
  await page.getByText('There is no picture of both').waitFor();
  assert.equal(await page.locator('.compare-legend').isVisible(), false);
  assert.deepEqual(await barriers(page), []);
  await screenshot(page, 'compare-other-place');
  await page.goto(compare(scans.Before, scans.Point));
  await page.getByText(/They could not be compared: the second scan/).waitFor();
  assert.ok(await page.getByRole('button', { name: 'Try again' }).isVisible());
  assert.deepEqual(viewer.complaints, []);
});

test('a share link shows one scan only, and a deleted scan takes the comparison along', {
  timeout: limit_ms,
}, async () => {
  const { path: link } = await (
    await fetch(`${server.origin}/api/v1/scans/${scans.Before}/shares`, {
      method: 'POST',
      headers,
      body: '{}',
    })
  ).json();
  const context = await browser.browser.newContext();
  const guest = await openPage(context, `${server.origin}${link}&page=compare&with=${scans.After}`);
  await guest.page.getByText('A share link shows one scan').waitFor();
  await context.close();
  const { page } = viewer;
  await page.goto(compare(scans.Before, scans.After));
  await shown(page);
  await fetch(`${server.origin}/api/v1/scans/${scans.After}`, { method: 'DELETE', headers });
  await page.evaluate(() => document.dispatchEvent(new Event('visibilitychange')));
  await page.getByText('One of both scans has been deleted.').waitFor();
  const { comparisons } = await (
    await fetch(`${server.origin}/api/v1/scans/${scans.Before}/comparisons`, { headers })
  ).json();
  assert.ok(comparisons.every((one) => one.with !== scans.After));
});
