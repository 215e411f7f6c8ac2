// The pictures of web/SCREENSHOTS.md: every view of the viewer on a desk and on a phone, of
// synthetic scans that the real client sends to a real server.
//
//   node tests/web/pictures.mjs [VIEW...]
//
// HERMITE_BUILD: where the programs are (build/release).
//
// Without names all of them are made, into web/pictures/views.
import assert from 'node:assert/strict';
import { mkdir, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { openPage, openServerAndBrowser, until, untilResting, untilScan } from './browser.mjs';
import { root, startStream } from './programs.mjs';

const pictures = path.join(root, 'web/pictures/views');
const limit_ms = 3 * 60_000; // two slow cores do three things at once here
const quality = 0.7; // of a JPEG
const small = 'width=320,height=240';

const sizes = {
  desktop: { context: { viewport: { width: 1280, height: 800 } }, width_px: 960 },
  phone: {
    context: {
      viewport: { width: 390, height: 844 },
      deviceScaleFactor: 2,
      hasTouch: true,
      isMobile: true,
    },
    width_px: 390,
  },
};

const changes = 'moved=chair:180:120:0/ball:0:250:0,removed=globe';
// Scans that have ended, by what the views call them.
const recordings = {
  room: { title: 'Living room', sequence: `synthetic:frames=300,rate=15,${small},noise=kinect` },
  later: {
    title: 'Living room, a week later',
    sequence: `synthetic:frames=300,rate=15,${small},noise=kinect,seed=2,${changes}`,
  },
  doubtful: {
    title: 'With a hand in front of the lens',
    sequence: `synthetic:frames=150,rate=15,${small},noise=kinect+covered=70:12`,
  },
  round: { title: 'Living room, one round', sequence: `synthetic:frames=150,rate=15,${small}` },
  table: {
    title: 'Things on a table',
    sequence: `synthetic:scene=turntable,frames=50,rate=5,${small}`,
  },
  office: { title: 'Office', sequence: `synthetic:scene=office,frames=50,rate=15,${small}` },
  wall: { title: 'Words on a wall', sequence: `synthetic:scene=poster,frames=40,rate=15,${small}` },
};
// Scans that run while somebody looks, at frames a second that leave the page
// its share of the machine.
const runs = {
  growing: {
    title: 'Study',
    sequence: `synthetic:frames=4000,rate=15,${small},start=2`,
    rate: '3',
  },
  lost: {
    title: 'Study, camera lost',
    sequence: `synthetic:frames=4000,rate=15,${small},start=2+covered=70:3000`,
    rate: '3',
  },
};

let setup, server, browser, decoder, client;
const ids = new Map(); // of scans, by title
const links = {}; // how a view on a desk was left, for the phone

async function ask(route) {
  const response = await fetch(`${server.origin}/api/v1/${route}`, {
    headers: { Authorization: `Bearer ${server.token}` },
  });
  assert.ok(response.ok, `${route}: ${response.status}`);
  return response.json();
}

async function untilListed(title) {
  for (
    const end_ms = Date.now() + limit_ms;
    Date.now() < end_ms;
    await new Promise((resolve) => setTimeout(resolve, 200))
  ) {
    const found = (await ask('scans')).scans.find((scan) => scan.title === title);
    if (found) return found.id;
  }
  return assert.fail(`${title} is not in the list`);
}

// The scan that has ended, sent first where it is not there yet.
async function ended(name) {
  const { title, sequence } = recordings[name];
  if (ids.has(title)) return ids.get(title);
  client?.stop(); // the machine is for this one
  const streamed = startStream(server, { sequence, title });
  assert.equal(await streamed.end(limit_ms), 0, streamed.output());
  ids.set(title, await untilListed(title));
  return ids.get(title);
}

// The scan that runs, in place of the one before.
async function running(name) {
  const { title, sequence, rate } = runs[name];
  if (!ids.has(title)) {
    client?.stop();
    client = startStream(server, { sequence, title, rate });
    ids.set(title, await untilListed(title));
  }
  return ids.get(title);
}

async function opened(page, id, more = '') {
  client?.stop();
  await page.goto(`${server.origin}/#token=${server.token}&scan=${id}${more}`);
  await untilScan(
    page,
    'the surface with its image',
    limit_ms,
    ({ mesh }) => mesh.state === 'shown' && mesh.textured,
  );
  await untilResting(page, limit_ms);
}

async function watched(page, name, frames) {
  await page.goto(`${server.origin}/#token=${server.token}&scan=${await running(name)}`);
  await untilScan(
    page,
    `${frames} frames`,
    limit_ms,
    (scan) => scan.framesProcessed >= frames && scan.triangles > 0,
  );
}

const imageIn = (page, selector) =>
  until(
    page,
    `an image in ${selector}`,
    (where) => {
      const canvas = document.querySelector(`${where} canvas.frame-image:not(.missing)`);
      return canvas?.checkVisibility() && canvas.width !== 300; // 300: nothing was drawn yet
    },
    selector,
    limit_ms,
  );

// By its key on a desk, by a button or the menu on a phone.
async function tool(page, isPhone, key, label, isInMenu = true) {
  if (!isPhone) return page.locator('.picture').press(key);
  if (isInMenu) await page.getByRole('button', { name: 'More' }).tap();
  return page.getByRole('button', { name: label, exact: true }).tap();
}

const press = (page, isPhone, [x, y]) =>
  isPhone ? page.touchscreen.tap(x, y) : page.mouse.click(x, y);

async function drag(page, [x, y], [toX, toY]) {
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (const share of [0.3, 0.6, 1])
    await page.mouse.move(x + share * (toX - x), y + share * (toY - y));
  await page.mouse.up();
}

// Where the mouse can take hold of the clip box.
const handleNear = (page, x, y) =>
  page.evaluate(
    (middle) => {
      const canvas = document.querySelector('.picture');
      for (let reach = 0; reach < 120; reach += 4)
        for (let turn = 0; turn < 24; ++turn) {
          const at = middle.map(
            (value, axis) =>
              value + reach * (axis === 0 ? Math.cos(turn * 0.2618) : Math.sin(turn * 0.2618)),
          );
          canvas.dispatchEvent(
            new PointerEvent('pointermove', {
              clientX: at[0],
              clientY: at[1],
              pointerType: 'mouse',
              bubbles: true,
            }),
          );
          if (canvas.classList.contains('on-handle')) return at;
        }
      throw new Error('there is no handle');
    },
    [x, y],
  );

async function writeNote(page, at, content) {
  const panel = page.getByRole('region', { name: 'Notes' });
  await page.mouse.click(...at);
  await panel.locator('textarea').fill(content);
  await panel.getByRole('button', { name: 'Save', exact: true }).click();
  await panel.locator('.note-whole').getByText(content).waitFor();
}

// Each brings the page to what is shown. `light`: on a desk, so that both themes are seen.
const views = {
  list: {
    light: true,
    show: async (page) => {
      for (const name of ['round', 'table', 'office', 'wall']) await ended(name);
      await running('growing');
      await page.goto(`${server.origin}/#token=${server.token}`);
      await page.getByText('Scanning').first().waitFor();
      const all = () =>
        document.querySelector('.thumbnail.there') &&
        !document.querySelector('.thumbnail:not(.there)');
      await until(page, 'all small images', all, undefined, limit_ms);
    },
  },
  growing: {
    show: async (page) => {
      await watched(page, 'growing', 60);
      await imageIn(page, '.frame-picture:nth-child(2)');
      await imageIn(page, '.frame-picture:nth-child(3)');
    },
  },
  coverage: {
    show: async (page) => {
      await watched(page, 'growing', 80);
      await page.getByRole('button', { name: 'Coverage' }).click();
      await page
        .locator('.coverage li')
        .filter({ hasText: 'Needs another look' })
        .getByText(/^\d+ %$/)
        .waitFor();
      await untilScan(
        page,
        'coverage is on the surface',
        limit_ms,
        (state) => state.surfaceHasConfidences === true && state.triangles > 0,
      );
      await page.waitForTimeout(3000); // the rest of the surface comes
    },
  },
  lost: {
    show: async (page, isPhone) => {
      await watched(page, 'lost', 60);
      await untilScan(
        page,
        'the camera is lost',
        limit_ms,
        (state) => state.tracking === 'lost' && state.wayBack !== null,
      );
      await imageIn(page, '.way-back');
      await page.getByText(/^Go back here, seen/).waitFor();
      if (!isPhone) await page.getByRole('button', { name: 'Look from there' }).click();
      await page.waitForTimeout(2000);
    },
  },
  finished: { show: async (page) => opened(page, await ended('room')) },
  points: {
    show: async (page) => {
      await opened(page, await ended('room'));
      await page.locator('.segments.show').getByText('Points', { exact: true }).click();
      await page.getByText('Normals').filter({ visible: true }).click();
    },
  },
  measure: {
    light: true,
    show: async (page, isPhone) => {
      await opened(page, await ended('room'));
      await tool(page, isPhone, 'm', 'Measure', false);
      await page.getByText('Click on two points.').waitFor();
      for (const at of isPhone
        ? [
            [271, 497],
            [229, 598],
          ]
        : [
            [619, 373],
            [777, 417],
          ]) {
        await untilResting(page, limit_ms); // on a phone the model makes room for the panel
        await press(page, isPhone, at);
      }
      await page
        .locator('.measure-newest')
        .getByText(/^\d+\.\d{3} m ± 0\.\d{3} m \(95 %\)$/)
        .waitFor();
      await page
        .getByRole('textbox', { name: 'Name of the measurement' })
        .fill(isPhone ? 'Across the carpet' : 'Width of the carpet');
      await page.getByRole('button', { name: 'Keep' }).click();
      await page.locator('.measure-list').getByText(/ m ± /).first().waitFor();
    },
  },
  section: {
    show: async (page, isPhone) => {
      await opened(page, await ended('room'), isPhone ? links.section : '');
      await tool(page, isPhone, 'x', 'Section');
      if (!isPhone) {
        await page.getByRole('button', { name: 'Clip box' }).click();
        await page.locator('.section-kind').getByText('Horizontal').click();
        await untilResting(page, limit_ms);
        const from = await handleNear(page, 465, 599);
        await drag(page, from, [from[0] + 0.4 * (640 - from[0]), from[1] + 0.4 * (480 - from[1])]);
        const fields = () => location.hash.includes('clip=') && `&${location.hash.split('?')[1]}`;
        links.section = await until(page, 'the address has the box', fields);
      }
      await page
        .locator('.section-words')
        .getByText(/of lines/)
        .waitFor();
    },
  },
  frames: {
    show: async (page, isPhone) => {
      await opened(page, await ended('room'));
      await tool(page, isPhone, 't', 'Frames');
      await page.getByRole('slider', { name: 'Frame' }).fill('190');
      await page.locator('.frame-facts').getByText('Frame 190 /').waitFor();
      await page
        .locator('.depth-scale')
        .getByText(/^\d\.\d m$/)
        .first()
        .waitFor();
      await page.waitForTimeout(1000); // the images of just that frame
    },
  },
  notes: {
    show: async (page, isPhone) => {
      await opened(page, await ended('room'));
      await tool(page, isPhone, 'n', 'Notes');
      if (!isPhone) {
        await writeNote(page, [735, 208], 'Hang this picture 10 cm lower, please.');
        await writeNote(page, [716, 519], 'A stain on the carpet.');
      } else
        await page
          .getByRole('region', { name: 'Notes' })
          .getByRole('button', { name: 'Note 2' })
          .tap();
    },
  },
  quality: {
    show: async (page) => {
      await page.goto(
        `${server.origin}/#token=${server.token}&scan=${await ended('doubtful')}&page=quality`,
      );
      await page.locator('.doubt').first().waitFor({ timeout: limit_ms });
      await page.locator('.model-picture').nth(5).waitFor({ timeout: limit_ms });
      await page.waitForTimeout(1000);
    },
  },
  compare: {
    show: async (page) => {
      const [before, after] = [await ended('room'), await ended('later')];
      await page.goto(
        `${server.origin}/#token=${server.token}&scan=${before}&page=compare&with=${after}`,
      );
      await page
        .getByText(/changes? on \d+\.\d m² that both scans saw/)
        .waitFor({ timeout: limit_ms });
      const both = () => window.hermite.drawCalls() > 1 && window.hermite.isResting();
      await until(page, 'both scans are in the picture', both, undefined, limit_ms);
    },
  },
  plan: {
    show: async (page, isPhone) => {
      await opened(page, await ended('round'));
      await tool(page, isPhone, 'p', 'Floor plan');
      const picture = page.getByRole('img', { name: 'Floor plan of' });
      await picture.waitFor({ timeout: limit_ms });
      await picture.evaluate((image) => image.decode());
    },
  },
  downloads: {
    show: async (page) => {
      await opened(page, await ended('room'));
      await page.getByRole('button', { name: 'Download', exact: true }).click();
      await page.getByRole('button', { name: /^GLB, opens/ }).waitFor();
      await page.waitForTimeout(1000); // what is there says how large it is
    },
  },
};

// A JPEG that is as wide as it will be seen.
async function jpeg(png, width_px) {
  decoder ??= await browser.context.newPage();
  const base64 = await decoder.evaluate(
    async ([source, width, q]) => {
      const image = new Image();
      image.src = `data:image/png;base64,${source}`;
      await image.decode();
      const canvas = Object.assign(document.createElement('canvas'), {
        width,
        height: Math.round((image.height * width) / image.width),
      });
      const drawing = canvas.getContext('2d');
      drawing.imageSmoothingQuality = 'high';
      drawing.drawImage(image, 0, 0, canvas.width, canvas.height);
      return canvas.toDataURL('image/jpeg', q).split(',')[1];
    },
    [png.toString('base64'), width_px, quality],
  );
  return Buffer.from(base64, 'base64');
}

async function take(name, size) {
  const isPhone = size === 'phone';
  const colorScheme = views[name].light && !isPhone ? 'light' : 'dark';
  const context = await browser.browser.newContext({
    ...sizes[size].context,
    colorScheme,
    locale: 'en-GB',
    reducedMotion: 'reduce',
  });
  context.setDefaultTimeout(60_000);
  const { page, complaints } = await openPage(context, 'about:blank');
  try {
    await views[name].show(page, isPhone);
    if (!runs[name] && !['list', 'coverage', 'quality'].includes(name))
      await untilResting(page, limit_ms);
  } catch (error) {
    await page.screenshot({ path: path.join(setup.artifacts, `${name}-${size}-failed.png`) });
    throw error;
  }
  const bytes = await jpeg(await page.screenshot(), sizes[size].width_px);
  await writeFile(path.join(pictures, `${name}-${size}.jpg`), bytes);
  console.log(
    [`${name}-${size}.jpg: ${Math.round(bytes.length / 1024)} KiB`, ...complaints].join('\n  '),
  );
  await context.close();
}

const wanted = process.argv.slice(2);
const unknown = wanted.filter((name) => !views[name]);
assert.deepEqual(unknown, [], `the views are ${Object.keys(views).join(', ')}`);
await mkdir(pictures, { recursive: true });
try {
  setup = await openServerAndBrowser('pictures');
  ({ server, browser } = setup);
  for (const name of wanted.length > 0 ? wanted : Object.keys(views)) {
    for (const size of Object.keys(sizes))
      await take(name, size).catch((error) => {
        process.exitCode = 1;
        console.error(`${name}-${size}: ${error.message}`);
      });
  }
} finally {
  client?.stop();
  await setup?.close();
}
