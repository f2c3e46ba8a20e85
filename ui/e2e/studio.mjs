// SPDX-License-Identifier: Apache-2.0
// Drives a real robot through the page in a real browser. Status 77: there is no browser.
//   node studio.mjs SEGUE SCREENSHOT_FOLDER
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { driveEdit, observeEdit } from './edit.mjs';
import { end, Stage } from './stage.mjs';

const stage = new Stage(...process.argv.slice(2));
const { folder } = stage;
const capture = (page, name) => stage.capture(page, name);
const run = (args) => stage.run(args);

const startRobot = (file) => stage.start(['run', file, '--controller', 'explore'], /robot rover runs/);

/** A controller that cannot be configured is added to the robot. */
function addFailingController() {
  const go = readFileSync(join(folder, 'rover/controllers/go_to.yaml'), 'utf8');
  const broken = go
    .replace('network: go_to', 'network: broken')
    .replace('"demo::LaserScanner"', '"demo::LaserScanner", properties: {beams: 1}');
  writeFileSync(join(folder, 'rover/controllers/broken.yaml'), broken);
}

/** Drives to a place that is near and one where it never arrives; what comes after it waits. */
const tour = `mission: tour
actions:
  think: {pure: true, outputs: {place: map}, run: {simulated: {duration: 200ms, outputs: {place: {x: 1000.0, y: 0.0}}}}}
  drive_to:
    inputs: {place: map}
    run:
      controller: go_to
      set: {seeker.speed: 2.0}
      call: {seeker.set_goal: {goal: "{place}"}}
      until: [{task: seeker, state: arrived}, {after: 5min}]
start: outward
states:
  outward:
    start: near
    flows: [think.place -> far.place]
    states:
      near: {action: drive_to, inputs: {place: {x: 0.2, y: 0.0}}, on: {success: think}}
      think: {on: {success: far}}
      far: {action: drive_to, on: {success: return success}}
    on: {success: home}
  home: {action: drive_to, inputs: {place: {x: 0.0, y: 0.0}}, on: {success: return success}}
`;

async function drive(page) {
  const seen = (locator) => locator.waitFor();

  // The keys, once the page listens to them.
  await seen(page.getByText('4 tasks, 4 connections'));
  await page.keyboard.press('?');
  await seen(page.getByRole('dialog', { name: 'Keys' }).getByText('sets or removes a breakpoint'));
  await capture(page, 'keys');
  await page.keyboard.press('Escape');
  await page.getByRole('dialog', { name: 'Keys' }).waitFor({ state: 'hidden' });

  // Look at a task.
  await seen(page.getByText('4 tasks, 4 connections'));
  await page.locator('.react-flow__node[data-id=drive]').click();
  const panel = page.getByRole('complementary', { name: 'Task drive' });
  await seen(panel.getByLabel('max_speed'));
  await panel.getByRole('button', { name: 'output velocity' }).click();
  await seen(panel.locator('.plot canvas'));
  await capture(page, 'network');

  // Set a property.
  await panel.getByLabel('max_speed').fill('0.45');
  await panel.getByLabel('max_speed').press('Enter');
  await seen(panel.locator('output.good', { hasText: 'set' }));
  assert.equal(JSON.parse(run(['task', 'drive', '--format', 'json'])).properties.max_speed, 0.45);
  await panel.getByLabel('max_speed').fill('[1, fast]');
  await panel.getByLabel('max_speed').press('Enter');
  await seen(panel.locator('output.bad'));

  // Call an operation.
  await page.keyboard.press('Escape');
  await page.keyboard.press('Escape');
  await page.getByPlaceholder('Find tasks').fill('odom');
  await page.getByPlaceholder('Find tasks').press('Enter');
  const odometry = page.getByRole('complementary', { name: 'Task odometry' });
  await odometry.getByRole('button', { name: 'Call reset' }).click();
  await seen(odometry.locator('output.good', { hasText: 'done' }));
  await page.getByPlaceholder('Find tasks').fill('');

  // Switch and watch.
  await page.getByRole('link', { name: 'Switch' }).click();
  await page.getByRole('button', { name: 'go_to', exact: true }).click();
  await seen(page.locator('.task-box.fate-added').first());
  await capture(page, 'switch_before');
  await page.getByRole('button', { name: 'Switch', exact: true }).click();
  await seen(page.locator('.outcome.good', { hasText: 'done' }));
  await page.waitForFunction(() => {
    const actions = [...document.querySelectorAll('[data-progress]')];
    return actions.length > 0 && actions.every((action) => action.dataset.progress === 'done');
  });
  await capture(page, 'switch_after');
  assert.equal(JSON.parse(run(['status', '--format', 'json'])).controller, 'go_to');

  // A switch that fails is undone.
  await page.getByRole('button', { name: 'broken', exact: true }).click();
  await page.getByRole('button', { name: 'Switch', exact: true }).click();
  await seen(page.locator('.outcome.bad', { hasText: 'Undone' }));
  await seen(page.locator('[data-progress=failed]'));
  await capture(page, 'switch_failed');
  assert.equal(JSON.parse(run(['status', '--format', 'json'])).controller, 'go_to');

  // Events.
  await page.getByRole('link', { name: 'Events' }).click();
  await page.getByPlaceholder('Find events').fill('transition');
  await seen(page.getByRole('cell', { name: 'transition_done' }).first());
  await capture(page, 'events');
}

const startMission = () => stage.start(['mission', 'run', 'tour.yaml', '--mode', 'concurrent', '--follow', '--no-progress'], /began outward\/far/);

async function driveMission(page) {
  const seen = (locator) => locator.waitFor();
  writeFileSync(join(folder, 'tour.yaml'), tour);
  await page.getByRole('link', { name: 'Missions' }).click();
  await seen(page.getByText('No mission has commanded the robot'));
  await capture(page, 'missions_none');

  // Running states are lit, and what waits says for what.
  const first = await startMission();
  const state = (path) => page.locator('.react-flow__node[data-id="state:' + path + '"]');
  await seen(state('outward/far').locator('.life-running'));
  await seen(state('outward/near').locator('.life-done'));
  await seen(state('home').locator('.life-waiting', { hasText: 'waits for outward/far (' }));
  await seen(page.getByRole('group', { name: 'Legend' }).getByText('waits', { exact: true }));
  await seen(state('outward').locator('.life-running'));
  await page.getByPlaceholder('Find nodes').fill('home');
  await page.getByPlaceholder('Find nodes').press('Enter');
  const home = page.getByRole('complementary', { name: 'State home' });
  await seen(home.getByText('waiting'));
  await seen(home.getByText('waits for outward/far ('));
  await page.getByPlaceholder('Find nodes').fill('');
  await capture(page, 'missions');
  await home.getByRole('button', { name: /outward\/far/ }).click();
  const far = page.getByRole('complementary', { name: 'State outward/far' });
  await seen(far.getByText('running').first());
  await page.locator('.chart').press('ArrowUp');
  await seen(page.getByRole('complementary', { name: 'State outward/think' }).getByText('done').first());
  await page.keyboard.press('Escape');

  // Containers close and open, and are selected.
  await state('outward').focus();
  await page.keyboard.press('ArrowLeft');
  await state('outward/far').waitFor({ state: 'detached' });
  await state('outward').getByRole('button', { name: 'Open ▶ outward' }).click();
  await seen(state('outward/far'));
  await state('outward').press('Enter');
  const outward = page.getByRole('complementary', { name: 'State outward', exact: true });
  await outward.getByRole('button', { name: 'Close in the graph' }).click();
  await state('outward/far').waitFor({ state: 'detached' });
  await page.getByRole('button', { name: 'open all' }).click();
  await seen(state('outward/far'));
  await page.keyboard.press('Escape');

  // Pause and resume, as the command line sees it, too.
  const badge = (text) => page.locator('.main > .bar .badge', { hasText: text });
  await page.getByRole('button', { name: 'Pause' }).click();
  await seen(badge('paused'));
  assert.equal(JSON.parse(run(['mission', 'status', '--format', 'json'])).state, 'paused');
  await page.getByRole('button', { name: 'Resume' }).click();
  await seen(badge('running'));

  // A mission that is killed shows as such; the next one is stopped.
  first.child.kill('SIGKILL');
  await seen(badge('killed or lost'));
  await page.emulateMedia({ colorScheme: 'dark' });
  await capture(page, 'missions_killed_dark');
  await page.emulateMedia({ colorScheme: 'light' });
  const second = await startMission();
  const ended = new Promise((resolve) => second.child.on('exit', resolve));
  await seen(state('outward/far').locator('.life-running'));
  await page.getByRole('button', { name: 'Stop', exact: true }).click();
  await seen(badge('ended: preempted'));
  await ended;

  // A run that was recorded.
  writeFileSync(join(folder, 'run.json'), run(['mission', 'run', 'tour.yaml', '--mode', 'concurrent', '--clock', 'virtual', '--simulate', '--format', 'json']));
  await page.getByLabel('Open a recorded run').setInputFiles(join(folder, 'run.json'));
  await seen(badge('recorded'));
  await seen(page.getByText('4 nodes', { exact: true }));
  await page.getByLabel('Open a recorded run').setInputFiles(join(folder, 'tour.yaml'));
  await seen(page.getByRole('alert').filter({ hasText: 'tour.yaml: this is not JSON' }));
  await capture(page, 'missions_recorded');
  await page.getByRole('button', { name: 'Back to the robot' }).click();
  await seen(badge('ended: preempted'));
}

/** The red button, whatever view is shown; and that the robot is held until it is released. */
async function stopAndRelease(page) {
  await page.getByRole('button', { name: 'Stop the robot' }).click();
  const banner = page.getByRole('alert').filter({ hasText: 'Halted by' });
  await banner.filter({ hasText: 'at rest' }).filter({ hasText: 'refused until it is released' }).waitFor();
  assert.equal(JSON.parse(run(['status', '--format', 'json'])).controller, 'hold');
  await capture(page, 'stopped');
  await page.getByRole('button', { name: 'Release' }).click();
  await page.getByRole('button', { name: 'Release' }).waitFor({ state: 'detached' });
  run(['switch', 'explore']);
  await banner.waitFor({ state: 'detached' });
}

await stage.play(async () => {
  run(['init', 'rover']);
  addFailingController();
  let robot = await startRobot('rover/robot.yaml');
  const page = await stage.enter();
  await drive(page);
  await driveMission(page);
  await stopAndRelease(page);
  await driveEdit(page, { folder, capture, run });
  const observing = await stage.startStudio('--observe');
  const observer = await stage.browser.newPage();
  await observer.goto(observing.found);
  await observer.getByText('observe only').waitFor();
  assert.equal(await observer.getByRole('button', { name: 'Stop the robot' }).count(), 0);
  await observeEdit(observer);
  await observer.close();
  assert.equal(await end(observing.child), 0);

  // The runtime ends and starts again.
  await end(robot.child);
  await page.getByText('The robot cannot be reached').waitFor();
  robot = await startRobot('rover/robot.yaml');
  await page.getByText('The robot cannot be reached').waitFor({ state: 'detached' });
  await page.getByRole('link', { name: 'Network' }).click();
  await page.getByText('4 tasks, 4 connections').waitFor();
  await page.emulateMedia({ colorScheme: 'dark' });
  await page.locator('.react-flow__node[data-id=laser]').click();
  await page.getByRole('complementary', { name: 'Task laser' }).getByLabel('beams').waitFor();
  await capture(page, 'network_dark');
  assert.equal(await end(stage.studio.child), 0);
  await end(robot.child);
});
