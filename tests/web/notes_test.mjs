// Notes in the real server and a real browser: two people write and change them at once, a link
// shows one, a guest only reads.
//
//   node --test tests/web/notes_test.mjs
//
// HERMITE_BUILD: where the programs are (build/release). HERMITE_ARTIFACTS: where images go.
import assert from 'node:assert/strict';
import path from 'node:path';
import { after, before, test } from 'node:test';
import {
  barriers,
  brightnessOf,
  openServerAndBrowser,
  openPage,
  tooSmall,
  untilResting,
  untilScan,
} from './browser.mjs';

const limit_ms = 60_000;
const script = 'A crack <img src=x onerror="document.title=1">\nin the wall';
let setup, artifacts, server, browser, scanId, ada;

before(async () => {
  setup = await openServerAndBrowser('notes');
  ({ server, browser, artifacts } = setup);
  scanId = await importedCorner();
  ada = await opened(browser.context, `#token=${server.token}&scan=${scanId}`);
});

after(() => setup?.close());

const screenshot = (page, name) => page.screenshot({ path: path.join(artifacts, `${name}.png`) });

async function ask(method, route, body, token = server.token) {
  const response = await fetch(`${server.origin}/api/v1/${route}`, {
    method,
    body,
    headers: { Authorization: `Bearer ${token}` },
  });
  return { status: response.status, json: await response.json() };
}

// The corner of a room: a floor and two walls of 3 m, z up, as a mesh of another program.
async function importedCorner() {
  const floor = ['0 0 0 120 110 100', '3 0 0 150 110 90', '3 3 0 120 130 100', '0 3 0 90 110 140'];
  const above = ['0 0 3 200 190 170', '3 0 3 170 190 200', '0 3 3 190 170 160'];
  const faces = ['4 0 1 2 3', '4 0 4 5 1', '4 0 3 6 4'];
  const columns = ['float x', 'float y', 'float z', 'uchar red', 'uchar green', 'uchar blue'].map(
    (one) => `property ${one}`,
  );
  const lists = ['element face 3', 'property list uchar int vertex_indices', 'end_header'];
  const header = ['ply', 'format ascii 1.0', 'element vertex 7', ...columns, ...lists];
  const { json } = await ask(
    'PUT',
    'uploads/Corner.ply',
    [...header, ...floor, ...above, ...faces, ''].join('\n'),
  );
  for (let i = 0; i < 300; ++i) {
    const { state, scan, words } = (await ask('GET', `jobs/${json.job}`)).json;
    if (state === 'finished') return scan;
    assert.notEqual(state, 'failed', words);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  return assert.fail('the import does not end');
}

async function opened(context, fragment) {
  const one = await openPage(context, `${server.origin}/${fragment}`);
  await untilScan(one.page, 'the surface is shown', limit_ms, ({ mesh }) => mesh.state === 'shown');
  await untilResting(one.page);
  return one;
}

const panel = (page) => page.getByRole('region', { name: 'Notes' });
const act = (page, name) => panel(page).getByRole('button', { name, exact: true }).click();
const text = (page) => panel(page).locator('textarea');

// Ctrl and Enter twice, faster than any answer.
function saveTwice(node) {
  for (let i = 0; i < 2; ++i)
    node.dispatchEvent(
      new KeyboardEvent('keydown', {
        key: 'Enter',
        ctrlKey: true,
        bubbles: true,
        cancelable: true,
      }),
    );
}

// Writes at this point of the page; returns the id of the note.
async function write(page, [x, y], content) {
  const before = page.url();
  await page.mouse.click(x, y);
  await text(page).fill(content);
  await text(page).evaluate(saveTwice);
  await panel(page).locator('.note-whole').getByText(content).waitFor();
  assert.equal(
    await page.evaluate(() => document.activeElement.ariaCurrent),
    'true',
    'the focus is on the note',
  );
  await page.waitForFunction(
    (old) => location.href !== old && /note=[a-z0-9]{26}/.test(location.hash),
    before,
  );
  return /note=([a-z0-9]{26})/.exec(page.url())[1];
}

test('a click puts a pin with a text, which a link shows to others as it was seen', {
  timeout: 2 * limit_ms,
}, async () => {
  const { page } = ada;
  await page.locator('.picture').press('n');
  await panel(page).getByText('Click on the model to write a note there.').waitFor();
  await page.mouse.click(60, 560);
  await panel(page).getByText('There is nothing').waitFor();
  // No letter of it is a key of the page.
  await write(page, [440, 430], 'The floor is wet: xmtfsc?');
  // To another view, which nothing glides to.
  for (let i = 0; i < 2; ++i) await page.locator('.picture').press('+');
  const id = await write(page, [520, 520], script);
  assert.equal(
    (await ask('GET', `scans/${scanId}/notes`)).json.notes.length,
    2,
    'each is written once',
  );
  await page.getByRole('button', { name: 'Show all' }).click();
  await panel(page).getByRole('button', { name: 'Note 2' }).click();
  const seen = await brightnessOf(browser.context, page);
  assert.deepEqual(await barriers(page), []);
  await screenshot(page, 'notes');
  const bens = await browser.browser.newContext({
    viewport: { width: 1024, height: 640 },
    colorScheme: 'dark',
    reducedMotion: 'reduce',
  });
  const ben = await opened(bens, `#token=${server.token}&scan=${scanId}&note=${id}`);
  await panel(ben.page).locator('.note-whole').getByText('A crack <img').waitFor();
  const linked = await brightnessOf(browser.context, ben.page);
  const off = seen.reduce((sum, value, i) => sum + Math.abs(value - linked[i]), 0) / seen.length;
  assert.ok(off < 2, `the link shows the same picture: it is ${off} grey values off`);

  // Both change the text.
  for (const one of [page, ben.page]) await act(one, 'Edit');
  await text(ben.page).fill('of Ben');
  await act(ben.page, 'Save');
  await panel(ben.page).locator('.note-whole').getByText('of Ben').waitFor();
  await text(page).fill('of Ada');
  await act(page, 'Save');
  await panel(page).getByText('Which text is to stay?').waitFor();
  await panel(page).getByText('of Ben', { exact: true }).first().waitFor();
  await page.keyboard.press('Escape');
  await panel(page).getByText('Which text is to stay?').waitFor();
  assert.equal(await text(page).inputValue(), 'of Ada');
  assert.deepEqual(await barriers(page), []);
  await screenshot(page, 'notes-conflict');
  await act(page, 'Keep both');
  await panel(page).locator('.note-whole').getByText('of Ada').waitFor();
  assert.equal((await ask('GET', `scans/${scanId}/notes`)).json.notes[1].text, 'of Ben\n\nof Ada');

  // What was removed comes back, what was changed meanwhile is not removed, and what somebody has
  // removed is written again.
  await act(page, 'Remove');
  await act(page, 'Undo');
  await panel(page).getByRole('button', { name: 'Note 2' }).click();
  await act(page, 'Edit');
  await text(page).fill('still wanted');
  assert.equal((await ask('DELETE', `scans/${scanId}/notes/${id}?version=3`)).status, 200);
  await act(page, 'Save');
  await panel(page).getByText('Somebody has removed this note').waitFor();
  await act(page, 'Save');
  await panel(page).locator('.note-whole').getByText('still wanted').waitFor();
  await ben.page.evaluate(() => dispatchEvent(new Event('focus')));
  await panel(ben.page).getByText('still wanted').waitFor();
  await page.setViewportSize({ width: 390, height: 844 });
  await act(page, 'Edit');
  assert.deepEqual(await tooSmall(page), []);
  await screenshot(page, 'notes-phone');
  // Out of what is written, of the choice and of the panel.
  for (let i = 0; i < 3; ++i) await page.keyboard.press('Escape');
  assert.equal(await panel(page).isVisible(), false);
  await page.waitForFunction(() => !location.hash.includes('note='));
  for (const one of [ada, ben])
    assert.deepEqual(
      one.complaints.filter((message) => !/status of (404|409)/.test(message)),
      [],
    );
  await bens.close();
});

test('text that was not saved is there again after a reload, until it is cancelled', {
  timeout: 2 * limit_ms,
}, async () => {
  const context = await browser.browser.newContext({
    viewport: { width: 1024, height: 640 },
    reducedMotion: 'reduce',
  });
  const { page, complaints } = await opened(context, `#token=${server.token}&scan=${scanId}`);
  const asked = [];
  page.on('dialog', (dialog) => {
    asked.push(dialog.type());
    void dialog.accept();
  });
  await page.locator('.picture').press('n');
  await panel(page).getByRole('button', { name: 'Note 1' }).click();
  await act(page, 'Edit');
  await text(page).fill('not saved yet');
  await page.reload();
  await text(page).waitFor();
  assert.equal(await text(page).inputValue(), 'not saved yet');
  assert.deepEqual(asked, ['beforeunload']);
  await page.locator('.picture').press('q');
  await text(page).waitFor({ state: 'detached' });
  await page.goBack();
  await text(page).waitFor();
  assert.equal(await text(page).inputValue(), 'not saved yet');
  await act(page, 'Cancel');
  await page.reload();
  await page.getByRole('button', { name: 'Notes (2)' }).waitFor();
  assert.equal(await text(page).isVisible(), false);
  assert.deepEqual(asked, ['beforeunload'], 'there is nothing to ask for');
  assert.deepEqual(complaints, []);
  await context.close();
});

test('a guest on a phone reads the notes and changes none', { timeout: 2 * limit_ms }, async () => {
  const link = (await ask('POST', `scans/${scanId}/shares`)).json.path.slice(1);
  const phone = {
    viewport: { width: 390, height: 844 },
    deviceScaleFactor: 2,
    hasTouch: true,
    isMobile: true,
  };
  const context = await browser.browser.newContext({
    ...phone,
    reducedMotion: 'reduce',
    colorScheme: 'light',
  });
  const { page, complaints } = await opened(context, link);
  await page.getByRole('button', { name: 'More' }).tap();
  await page.getByRole('button', { name: 'Notes', exact: true }).tap();
  await panel(page).getByText('Choose a note to see it.').waitFor();
  await page.touchscreen.tap(195, 420);
  assert.equal(await text(page).isVisible(), false);
  await panel(page).getByRole('button', { name: 'Note 1' }).tap();
  await panel(page).locator('.note-whole').getByText('The floor is wet').waitFor();
  assert.equal(
    await panel(page).getByRole('button', { name: 'Edit' }).count(),
    0,
    'what would be refused is not offered',
  );
  assert.deepEqual(await tooSmall(page), []);
  assert.deepEqual(await barriers(page), []);
  await untilResting(page);
  await screenshot(page, 'notes-phone-guest');
  assert.deepEqual(complaints, []);
  await context.close();
});
