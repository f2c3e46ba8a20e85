// SPDX-License-Identifier: Apache-2.0
// A robot that is healthy, crashed, half dead, repaired and lost, in a real browser. Status 77: there is no browser.
//   node health.mjs SEGUE SCREENSHOT_FOLDER
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { end, Stage } from './stage.mjs';

const [segue, pictures] = process.argv.slice(2);
const stage = new Stage(segue, pictures);
const status = () => JSON.parse(stage.run(['status', '--format', 'json']));
const pidOf = (task) => status().tasks.find((one) => one.id === task).pid;

/** The exit status of a command that may fail. */
function exitOf(args) {
  try {
    stage.run(args);
    return 0;
  } catch (error) {
    return error.status;
  }
}

const robotFile = 'robot: bot\ncontrollers: [drive.net]\nunits: {screws: 40}\npolicies: {on_failure: report}\n';
const drive = `network: drive
tasks:
  base: {component: x::Base}
  laser: {component: x::Laser}
  slam: {component: x::Slam}
deployments:
  sensors: {tasks: [laser]}
  mapping: {tasks: [slam]}
connections: [laser.scan -> slam.scan, slam.pose -> base.pose]
`;

const wrong = (page) => page.getByRole('alert', { name: 'What is wrong' });

async function repair(page) {
  await page.getByRole('button', { name: 'Repair' }).click();
  await wrong(page).waitFor({ state: 'detached' });
  await page.getByText('drive, idle').waitFor();
  assert.equal(exitOf(['status', '--exit-code']), 0);
}

/** What is wrong and its repair are on the screen in every view, also on a tablet. */
async function seenEverywhere(page) {
  const size = page.viewportSize();
  await page.setViewportSize({ width: 820, height: 1180 });
  for (const view of ['Switch', 'Missions', 'Plots', 'Events', 'Edit', 'Past', 'ROS 2', 'Network']) {
    await page.getByRole('link', { name: view, exact: true }).click();
    await wrong(page).getByText("process 'localhost/sensors' is gone").waitFor();
    const { x, y, width, height } = await page.getByRole('button', { name: 'Repair' }).boundingBox();
    assert.ok(x >= 0 && y >= 0 && x + width <= 820 && y + height <= 400, `Repair is at ${x}, ${y} in ${view}`);
  }
  await page.screenshot({ path: join(pictures, 'health_crashed_tablet.png') });
  await page.setViewportSize(size);
}

async function crash(page) {
  process.kill(pidOf('laser'), 'SIGKILL');
  await wrong(page).getByText("process 'localhost/sensors' is gone").waitFor();
  await page.getByText('in trouble: ').waitFor();
  assert.equal(exitOf(['status', '--exit-code']), 5);
  await stage.capture(page, 'health_crashed');
  await seenEverywhere(page);
  await page.getByRole('link', { name: 'Events' }).click();
  await page.getByLabel('only trouble').check();
  await page.locator('tr.trouble', { hasText: 'SIGKILL' }).first().waitFor();
  await page.getByRole('link', { name: 'Network' }).click();
  await repair(page);
}

async function hang(page) {
  process.kill(pidOf('slam'), 'SIGSTOP');
  await wrong(page).getByText("process 'localhost/mapping' does not answer").waitFor();
  assert.equal(exitOf(['status', '--exit-code']), 5);
  await stage.capture(page, 'health_half_dead');
  await repair(page);
}

await stage.play(async () => {
  writeFileSync(join(stage.folder, 'robot.yaml'), robotFile);
  writeFileSync(join(stage.folder, 'drive.net'), drive);
  const run = () => stage.start(['run', 'robot.yaml', '--controller', 'drive', '--stand-in'], /robot bot runs/);
  let robot = await run();
  await stage.settled('drive');
  const page = await stage.enter();
  await page.getByText('drive, idle').waitFor();
  await page.getByText('3 tasks, 2 connections').waitFor();
  await page.locator('.react-flow__node[data-id=laser]').waitFor();
  await page.getByText('units: screws 40').waitFor();
  await stage.capture(page, 'health_healthy');
  stage.run(['units', 'set', 'screws', '39']);
  await page.getByText('units: screws 39').waitFor();
  await crash(page);
  await hang(page);

  await end(robot.child);
  await page.getByText(/The robot cannot be reached: .*What is shown is of \d\d:\d\d:\d\d/).waitFor();
  // As it was seen last, which may be on its way down.
  await page.getByText(/(drive|the empty network), unknown/).waitFor();
  assert.equal(exitOf(['status', '--exit-code']), 3);
  await page.screenshot({ path: join(pictures, 'health_robot_lost.png') });
  robot = await run();
  await page.getByText('drive, idle').waitFor();
  await end(stage.studio.child);
  await page.getByText(/The studio cannot be reached.*What is shown is of \d\d:\d\d:\d\d/).waitFor();
  await page.locator('main.old').waitFor();
  await page.screenshot({ path: join(pictures, 'health_studio_lost.png') });
});
