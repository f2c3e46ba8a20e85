// SPDX-License-Identifier: Apache-2.0
// A 3D view of a real robot in a real browser, with WebGL and without. Status 77: there is no browser.
//   node space.mjs SEGUE SCREENSHOT_FOLDER
import assert from 'node:assert/strict';
import { Stage } from './stage.mjs';

const stage = new Stage(...process.argv.slice(2));

const panelOf = (page) => page.getByRole('region', { name: 'Around it', exact: true });

/** Waits until the canvas has pixels of about all these colours. */
async function coloured(canvas, colours) {
  const handle = await canvas.elementHandle();
  await canvas.page().waitForFunction(
    ([place, wanted]) => {
      const copy = document.createElement('canvas');
      [copy.width, copy.height] = [place.width, place.height];
      const context = copy.getContext('2d');
      context.drawImage(place, 0, 0);
      const { data } = context.getImageData(0, 0, copy.width, copy.height);
      const isThere = (colour) => {
        for (let at = 0; at < data.length; at += 4) if (data[at + 3] > 200 && colour.every((part, index) => Math.abs(data[at + index] - part) <= 24)) return true;
        return false;
      };
      return wanted.every(isThere);
    },
    [handle, colours],
    { polling: 300 },
  );
}

async function enter(address, ...options) {
  const page = await stage.openBrowser(...options);
  await page.setViewportSize({ width: 1280, height: 800 });
  // So that the test can read what was drawn.
  await page.addInitScript(() => {
    const before = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, given) {
      return before.call(this, kind, kind.startsWith('webgl') ? { ...given, preserveDrawingBuffer: true } : given);
    };
  });
  await page.goto(address);
  await page.waitForURL((now) => !now.search.includes('token'));
  await page.getByRole('link', { name: 'Plots' }).click();
  return page;
}

async function addPanel(page) {
  await page.getByRole('button', { name: 'Add a panel' }).click();
  const dialog = page.getByRole('dialog', { name: 'Add a panel' });
  for (const port of ['odometry.pose', 'laser.scan']) {
    await dialog.getByLabel('Find ports').fill(port);
    await dialog.getByRole('button', { name: port }).click();
    await dialog.getByLabel('the whole sample').check();
  }
  await dialog.getByRole('radio', { name: '3D view' }).check();
  await dialog.getByLabel('Title').fill('Around it');
  await dialog.getByRole('button', { name: 'Add', exact: true }).click();
  await panelOf(page).getByLabel('Size of Around it').selectOption('2 × 2');
}

/** The camera by mouse and keyboard; colours in light and dark. */
async function look(page) {
  const panel = panelOf(page);
  const canvas = panel.locator('canvas');
  await panel.getByText(/x -?\d+\.\d\d m, y/).waitFor();
  await coloured(canvas, [[179, 38, 30], [31, 95, 208]]); // the scan, the frames
  await stage.capture(page, 'space');
  const pictureOf = () => canvas.evaluate((place) => place.toDataURL());
  await panel.getByRole('button', { name: 'Pause Around it' }).click();
  await panel.getByText('Paused').waitFor();
  let before = await pictureOf();
  const changes = async (what) => {
    await page.waitForFunction(([place, old]) => place.toDataURL() !== old, [await canvas.elementHandle(), before], { polling: 100 });
    assert.notEqual(await pictureOf(), before, what);
    before = await pictureOf();
  };
  await canvas.focus();
  for (const key of ['ArrowRight', 'ArrowUp', 'Shift+ArrowLeft', '+']) {
    await page.keyboard.press(key);
    await changes(key);
  }
  const box = await canvas.boundingBox();
  await page.mouse.move(box.x + 200, box.y + 200);
  await page.mouse.down();
  await page.mouse.move(box.x + 260, box.y + 180);
  await page.mouse.up();
  await changes('dragging');
  await page.mouse.wheel(0, -300);
  await changes('the wheel');
  await panel.getByLabel('follow').check();
  await changes('following');
  await panel.getByRole('button', { name: 'All' }).click();
  await changes('fitting');
  assert.equal(await panel.getByLabel('follow').isChecked(), false);
  await panel.getByRole('button', { name: 'Go on with Around it' }).click();
  await page.emulateMedia({ colorScheme: 'dark' });
  await coloured(canvas, [[255, 157, 149], [130, 174, 252]]);
  await stage.capture(page, 'space_dark');
}

await stage.play(async () => {
  stage.run(['init', 'rover']);
  await stage.start(['run', 'rover/robot.yaml', '--controller', 'explore'], /robot rover runs/);
  await stage.settled('explore');
  const drawing = await enter((await stage.startStudio()).found, '--enable-unsafe-swiftshader', '--use-angle=swiftshader');
  const loaded = [];
  drawing.on('request', (request) => loaded.push(request.url()));
  await drawing.reload();
  await drawing.getByText('No panel yet').waitFor();
  assert.ok(!loaded.some((address) => /SpacePanel/.test(address)), 'it is loaded only where it is shown');
  await addPanel(drawing);
  await look(drawing);
  await stage.browser.close();

  const plain = await enter((await stage.startStudio()).found, '--disable-3d-apis');
  await panelOf(plain).or(plain.getByText('No panel yet')).first().waitFor();
  if ((await panelOf(plain).count()) === 0) await addPanel(plain);
  await panelOf(plain).getByText('This browser shows nothing in 3D').waitFor();
  await stage.capture(plain, 'space_without');
});
