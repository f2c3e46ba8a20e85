// SPDX-License-Identifier: Apache-2.0
// Every view on small and large screens and a tablet, of real and made-up robots: nothing sticks out, all text can be read, and axe finds
// nothing. Status 77: there is no browser.
//   node every_view.mjs SEGUE SCREENSHOT_FOLDER EXAMPLES [rover]      rover: with the simulated rover, whose components are built
import { dirname, join } from 'node:path';
import assert from 'node:assert/strict';
import { madeMission, madeNetwork } from './made.mjs';
import { servePage } from './page_server.mjs';
import { Stage } from './stage.mjs';

const [segue, pictures, examples, rover] = process.argv.slice(2);
const stage = new Stage(segue, pictures);
const sizes = [{ width: 1280, height: 800 }, { width: 1920, height: 1080 }, { width: 820, height: 1180 }];
const leastText = 11;
const problems = [];

/** What is too small to be read, or lies outside of the page or of what it is in. */
function faultsIn(least) {
  const faults = [];
  if (document.documentElement.scrollWidth > window.innerWidth) faults.push('the page is ' + document.documentElement.scrollWidth + ' px wide');
  const named = (one) => one.tagName.toLowerCase() + ' "' + (one.getAttribute('aria-label') ?? one.textContent).trim().slice(0, 40) + '"';
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const parent = node.parentElement;
    if (node.data.trim() === '' || !parent.checkVisibility({ visibilityProperty: true }) || parent.closest('.hidden, script, style, .cm-gutters, canvas')) continue;
    const viewport = parent.closest('.react-flow__viewport');
    const zoom = viewport ? new DOMMatrix(getComputedStyle(viewport).transform).a : 1;
    const size = parseFloat(getComputedStyle(parent).fontSize) * zoom;
    if (size < least - 0.05) faults.push(size.toFixed(1) + ' px: ' + named(parent));
  }
  const clips = (one) => one === document.body || getComputedStyle(one).overflowX !== 'visible';
  for (const control of document.querySelectorAll('button, a[href], input, select, textarea')) {
    if (!control.checkVisibility({ visibilityProperty: true }) || control.closest('.graph, .cm-editor, .hidden') || control.matches('[type=file]')) continue;
    let around = control.parentElement;
    while (!clips(around)) around = around.parentElement;
    const [inner, outer] = [control.getBoundingClientRect(), around.getBoundingClientRect()];
    if (inner.right > outer.right + 1 || inner.left < outer.left - 1) faults.push(named(control) + ' sticks out of ' + (around.className || around.tagName));
  }
  return [...new Set(faults)];
}

/** Looks at what is shown, on all screens; a graph gets its place a moment after the screen has its size. */
async function look(page, name) {
  if (await page.locator('.graph').count()) await page.locator('.react-flow__node').first().waitFor();
  for (const size of sizes) {
    await page.setViewportSize(size);
    let faults = null;
    for (const deadline = Date.now() + 20000; Date.now() < deadline && faults?.length !== 0; await new Promise((resolve) => setTimeout(resolve, 100))) {
      faults = await page.evaluate(faultsIn, leastText);
    }
    const where = `view_${name}_${size.width}`;
    await stage.capture(page, where).catch((error) => faults.push(error.message));
    problems.push(...faults.slice(0, 5).map((fault) => where + ': ' + fault));
    console.log(where + ': ' + (faults.join('; ') || 'good'));
  }
}

const views = ['Network', 'Switch', 'Missions', 'Plots', 'Events', 'Edit', 'Past'];
const go = (page, view) => page.getByRole('link', { name: view, exact: true }).click();

/** Shows something in the view, where it is empty at first. */
const openings = {
  async Network(page) {
    await page.locator('.react-flow__node').first().waitFor();
    await page.keyboard.press('/');
    await page.keyboard.type('a'); // what is found first is shown in the panel
    await page.keyboard.press('Enter');
    await page.getByRole('complementary').waitFor();
  },
  async Switch(page, { other }) {
    await page.getByRole('button', { name: 'prepare ' + other, exact: true }).click();
    await page.getByRole('button', { name: 'drop ' + other, exact: true }).waitFor();
    await page.getByRole('button', { name: new RegExp('^' + other) }).first().click();
    await page.getByRole('region', { name: 'Phase commit' }).waitFor();
  },
  async Missions(page, { mission }) {
    if (!mission) return;
    // Held before all of it: the rover has explored meanwhile, and what ran beside a state that is held might end the mission.
    await stage.start(['mission', 'run', join(examples, mission), '--break', 'guarded'], /held before/);
    await page.getByText('held before').waitFor();
  },
  async Plots(page) {
    await page.getByRole('button', { name: 'Add a panel' }).click();
    await page.getByRole('dialog').getByText('output ports').waitFor();
  },
  async Edit(page, { file }) {
    await page.getByRole('button', { name: file, exact: true }).click();
    await page.getByRole('region', { name: 'Edit ' + file }).waitFor();
  },
  async Past(page) {
    await page.locator('[data-request]').first().click();
    await page.getByRole('button', { name: 'Close the film' }).waitFor();
  },
};

async function lookAtAll(page, robot, known) {
  for (const view of views) {
    await go(page, view);
    await page.locator('main > *').first().waitFor();
    await openings[view]?.(page, known);
    await look(page, robot + '_' + view.toLowerCase());
    await page.keyboard.press('Escape');
  }
}

/** A robot of 300 tasks, which shows but answers nothing. */
async function lookAtLarge() {
  const shown = { status: { ...madeNetwork(300, 450, 60), controllers: Array.from({ length: 40 }, (_, index) => 'a_controller_with_a_long_name_' + index) }, mission: madeMission(300) };
  shown.status.ready = shown.status.controllers.slice(0, 3).map((controller) => ({ controller, ready: true, reason: '' }));
  const server = await servePage(join(dirname(segue), '../share/segue/studio'), 'large', (document, send) => shown[document] && send({ document, version: 1, value: shown[document] }));
  const page = await stage.openBrowser();
  await page.goto(server.address);
  for (const view of ['Network', 'Switch', 'Missions', 'Plots', 'Events']) {
    await go(page, view);
    await page.locator('main > *').first().waitFor();
    await look(page, 'large_' + view.toLowerCase());
  }
  await stage.browser.close();
  server.close();
}

await stage.play(async () => {
  await lookAtLarge();
  await stage.beside(join(examples, '04_artemis/robot.yaml'), 'search_explore', (page) => lookAtAll(page, 'artemis', { other: 'manipulation', file: 'controllers/manipulation.cnd' }));
  if (rover) {
    const known = { other: 'grasp', file: 'fetch_box.yaml', mission: '08_rover/fetch_box.yaml' };
    await stage.beside(join(examples, '08_rover/robot.yaml'), 'explore', (page) => lookAtAll(page, 'rover', known));
  }
  assert.deepEqual(problems, []);
});
