// SPDX-License-Identifier: Apache-2.0
// The views of a robot with one controller, which does nothing yet and keeps no journal: each says what would be there, and
// how it comes. Status 77: there is no browser.
//   node first_time.mjs SEGUE SCREENSHOT_FOLDER
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { end, Stage } from './stage.mjs';

const [segue, pictures] = process.argv.slice(2);
const stage = new Stage(segue, pictures);

function makeRobot() {
  mkdirSync(join(stage.folder, 'controllers'));
  writeFileSync(join(stage.folder, 'robot.yaml'), 'robot: lonely\nlibraries: [segue_components_demo]\ncontrollers: [controllers/*.yaml]\n');
  writeFileSync(join(stage.folder, 'controllers/look.yaml'), 'network: look\ntasks:\n  laser: {component: "demo::LaserScanner"}\n');
}

/** Waits for as long as a look at ROS 2 may take. */
async function helps(page, view, ...sentences) {
  await page.getByRole('link', { name: view, exact: true }).first().click(); // that of the header
  const help = page.locator('.empty');
  for (const sentence of sentences) await help.filter({ hasText: sentence }).waitFor();
  await stage.capture(page, 'first_time_' + view.toLowerCase().replace(' ', ''));
}

async function filterEvents(page) {
  await page.getByRole('link', { name: 'Events' }).click();
  await page.getByPlaceholder('Find events').fill('no event has this word');
  await page.locator('.empty', { hasText: 'take words out of the search' }).waitFor();
  await page.getByPlaceholder('Find events').fill('');
  await page.locator('.empty').waitFor({ state: 'detached' });
}

await stage.play(async () => {
  makeRobot();
  const robot = await stage.start(['run', 'robot.yaml', '--no-journal'], /robot lonely runs/);
  const page = await stage.enter();
  await helps(page, 'Network', 'those that do are drawn here', 'segue switch CONTROLLER');
  await helps(page, 'Switch', 'Choose a controller at the left');
  await helps(page, 'Missions', 'when each of them ran', 'segue mission run FILE');
  await helps(page, 'Plots', 'Press Add a panel');
  await helps(page, 'Edit', 'Choose a file at the left', 'New controller', 'segue apply');
  await helps(page, 'Past', 'Films of the robot', 'segue run --no-journal');
  await helps(page, 'ROS 2', 'segue ros2 describe', /No node was found in domain \d+|package segue-ros2/);

  // The way that Network names leads to tasks; then there is no other controller.
  await page.getByRole('link', { name: 'Network', exact: true }).click();
  await page.locator('.empty').getByRole('link', { name: 'Switch' }).click();
  await page.getByRole('button', { name: 'look', exact: true }).click();
  await page.getByRole('button', { name: 'Switch', exact: true }).click();
  await page.locator('.outcome.good', { hasText: 'done' }).waitFor();
  await page.getByRole('link', { name: 'Network', exact: true }).click();
  await page.getByText('1 task, 0 connections').waitFor();
  await helps(page, 'Switch', 'no other controller to switch to', 'under controllers in the robot file');
  await filterEvents(page);

  // A page that never heard the robot's events says what starts it.
  assert.equal(await end(robot.child), 0);
  await page.getByText('The robot cannot be reached').waitFor();
  await page.getByRole('link', { name: 'Events' }).click();
  await page.reload();
  await page.locator('.empty', { hasText: 'starts it' }).waitFor();
});
