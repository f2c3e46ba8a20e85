// SPDX-License-Identifier: Apache-2.0
// Every view on small and large screens and a tablet, of real and made-up robots: nothing sticks out, all text can be read, and axe finds
// nothing. Status 77: there is no browser.
//   node every_view.mjs SEGUE SCREENSHOT_FOLDER EXAMPLES [rover]      rover: with the simulated rover, whose components are built
import { dirname, join } from 'node:path';
import assert from 'node:assert/strict';
import { madeMission, madeNetwork } from './made.mjs';
import { servePage } from './page_server.mjs';
import { lookAt } from './screens.mjs';
import { Stage } from './stage.mjs';

const [segue, pictures, examples, rover] = process.argv.slice(2);
const stage = new Stage(segue, pictures);
const problems = [];
const look = async (page, name) => problems.push(...(await lookAt(stage, page, name)));

const views = ['Network', 'Switch', 'Missions', 'Plots', 'Events', 'Edit', 'Past', 'ROS 2'];
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
  // With nodes: ros2.mjs.
  async 'ROS 2'(page) {
    await page.locator('.empty', { hasText: /No node was found|The look is made/ }).waitFor();
  },
};

async function lookAtAll(page, robot, known) {
  for (const view of views) {
    await go(page, view);
    await page.locator('main > *').first().waitFor();
    await openings[view]?.(page, known);
    await look(page, robot + '_' + view.toLowerCase().replace(' ', ''));
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
  await page.getByText('300 tasks, 450 connections').waitFor();
  assert.equal(await page.getByRole('link', { name: 'ROS 2' }).count(), 0, 'neither the robot nor the computer has to do with it');
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
