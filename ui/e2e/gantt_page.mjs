// SPDX-License-Identifier: Apache-2.0
// The page that `segue mission gantt --html` writes, in a real browser. Status 77: there is no browser.
//   node gantt_page.mjs SEGUE SCREENSHOT_FOLDER
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { Stage } from './stage.mjs';

const [segue, pictures] = process.argv.slice(2);
const stage = new Stage(segue, pictures);

/** "grasp" needs what "look" gives, and the arm that "unfold" uses, so it waits for both. */
const mission = `mission: fetch
actions:
  look: {sensing: true, outputs: {box: map}, run: {simulated: {duration: 2s, outputs: {box: {x: 1.0}}}}}
  unfold: {resources: [{block: arm}], run: {simulated: {duration: 3s}}}
  grasp: {inputs: {box: map}, resources: [{block: arm}], run: {simulated: {duration: 4s}}}
start: look
flows: [look.box -> grasp.box]
states:
  look: {on: {success: unfold}}
  unfold: {on: {success: grasp}}
  grasp: {on: {success: return success}}
`;

/** How many pixels of the chart have that colour of the page. */
function pixelsOf(page, colour) {
  return page.evaluate((name) => {
    const wanted = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const canvas = document.getElementById('plot');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const rgb = [1, 3, 5].map((at) => Number.parseInt(wanted.slice(at, at + 2), 16));
    let count = 0;
    for (let at = 0; at < data.length; at += 4) if (rgb.every((value, part) => value === data[at + part])) ++count;
    return count;
  }, colour);
}

/** What is drawn comes with the next frame. */
async function until(page, what, holds) {
  for (const deadline = Date.now() + 10000; Date.now() < deadline; await page.waitForTimeout(50)) if (await holds()) return;
  assert.fail(what);
}

await stage.play(async () => {
  writeFileSync(join(stage.folder, 'fetch.yaml'), mission);
  stage.run(['mission', 'run', 'fetch.yaml', '--mode', 'concurrent', '--clock', 'virtual', '--html', 'fetch.html']);
  const page = await stage.openBrowser();
  await page.goto('file://' + join(stage.folder, 'fetch.html'));
  await page.getByRole('heading', { name: 'fetch' }).waitFor();
  await until(page, 'bars are drawn', async () => (await pixelsOf(page, '--sensing')) > 100 && (await pixelsOf(page, '--irreversible')) > 100);
  assert.ok((await pixelsOf(page, '--critical')) > 10, 'the critical path is framed');
  await stage.capture(page, 'gantt_page');

  // By keyboard: the node that was waited for, and a part of the time.
  const chart = page.getByRole('application', { name: 'Gantt chart' });
  await chart.focus();
  for (let row = 0; row < 3; ++row) await page.keyboard.press('ArrowDown');
  const detail = page.getByRole('region', { name: 'Selected node' });
  await detail.getByRole('heading', { name: 'grasp' }).waitFor();
  const before = await pixelsOf(page, '--sensing');
  for (const key of ['+', '+', 'Home']) await page.keyboard.press(key);
  await until(page, 'zooming makes the bar longer', async () => (await pixelsOf(page, '--sensing')) > 1.5 * before);
  await page.keyboard.press('w');
  await detail.getByRole('heading', { name: 'unfold' }).waitFor();

  // By resource, in the dark.
  await page.getByLabel('by resource').check();
  await page.emulateMedia({ colorScheme: 'dark' });
  await chart.press('0');
  await until(page, 'bars are drawn in the dark', async () => (await pixelsOf(page, '--irreversible')) > 100);
  await stage.capture(page, 'gantt_page_dark');
});
