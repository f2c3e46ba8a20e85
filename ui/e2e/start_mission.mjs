// SPDX-License-Identifier: Apache-2.0
// Starts missions of a real robot from the page, and opens past runs. Status 77: there is no browser.
//   node start_mission.mjs SEGUE SCREENSHOT_FOLDER
import { appendFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { end, Stage } from './stage.mjs';

const stage = new Stage(...process.argv.slice(2));

/** Looks around, and then watches for longer than anybody waits. */
const watch = `mission: watch
description: Looks around, and then watches the place.
resources: {cameras: {of: robot, count: 3}}
inputs:
  place: {type: text, default: the door}
  rounds: {type: int, default: 2}
  angles: list
  speed: {type: float, default: 0.5}
  quiet: {type: bool, default: false}
actions:
  look: {inputs: {rounds: int}, run: {simulated: {duration: 50ms}}}
  watch: {inputs: {place: text}, resources: [{block: cameras, count: 2}], run: {simulated: {duration: 10min}}}
start: look
flows: [inputs.rounds -> look.rounds, inputs.place -> watch.place]
states:
  look: {on: {success: watch}}
  watch: {on: {success: return success}}
`;

/** What a page shows. */
function partsOf(page) {
  const pane = page.getByRole('region', { name: 'Start a mission' });
  return {
    pane,
    runs: page.getByRole('region', { name: 'Past runs' }),
    input: (name) => pane.locator('[data-input=' + name + ']'),
    badge: (text) => page.locator('.main > .bar .badge', { hasText: text }),
    button: (name) => page.locator('.main > .bar').getByRole('button', { name, exact: true }),
  };
}

const status = () => JSON.parse(stage.run(['status', '--format', 'json']));
/** What the robot's journal has of missions, oldest first. */
const happened = () => JSON.parse(stage.run(['history', '--missions', '--format', 'json'])).filter((one) => one.mission === 'watch' && one.action === undefined);
const lastOutcome = () => happened().at(-1).outcome;

/** Waits until nobody commands the robot. */
async function free() {
  for (const deadline = Date.now() + 60000; Date.now() < deadline; await new Promise((resolve) => setTimeout(resolve, 50)))
    if (status().commanded_by === null) return;
  assert.fail('somebody commands the robot still');
}

/** A field that does not take its text says why; nothing is started then. */
async function correct(page) {
  const { pane, input, button } = partsOf(page);
  await button('Start a mission').click();
  await pane.getByLabel('Mission', { exact: true }).selectOption('watch.yaml');
  assert.equal(await input('place').getByRole('textbox').inputValue(), 'the door');
  await stage.capture(page, 'start_form');
  await input('rounds').getByRole('textbox').fill('many');
  await pane.getByRole('button', { name: 'Start', exact: true }).click();
  await input('rounds').getByText('a whole number is needed, such as 3').waitFor();
  await input('rounds').getByRole('textbox').fill('3');
  await input('angles').getByRole('textbox').fill('[1, 2');
  await pane.getByRole('button', { name: 'Start', exact: true }).click();
  await input('angles').getByText('this is not YAML').waitFor();
  await stage.capture(page, 'start_wrong');
  assert.equal(status().commanded_by, null);
  await input('angles').getByRole('textbox').fill('[1, 2]');
  await input('place').getByRole('textbox').fill('gate: 7');
}

/** It runs with what was filled in; a second one is refused, with who commands the robot. */
async function run(page) {
  const { pane, badge, button } = partsOf(page);
  await pane.evaluate((place) => {
    window.reasons = new Set();
    new MutationObserver(() => window.reasons.add(place.querySelector('[type=submit]')?.parentElement.querySelector('.why-not')?.textContent)).observe(place, { subtree: true, childList: true });
  });
  await pane.getByRole('button', { name: 'Start', exact: true }).click();
  await badge('running').waitFor();
  assert.ok(await page.evaluate(() => window.reasons.has('asked; the answer is under way')), 'it cannot be pressed twice, and says why');
  assert.equal(await pane.count(), 0);
  await page.locator('.react-flow__node[data-id="state:watch"] .life-running').waitFor();
  assert.match(status().commanded_by, /segue mission run for segue studio .*browser 1/);
  await page.locator('.react-flow__node[data-id="state:watch"]').click();
  await page.locator('[data-port=place]').getByText('"gate: 7"').waitFor();
  await stage.capture(page, 'start_runs');
  await page.keyboard.press('Escape');
  await page.getByRole('link', { name: 'Network' }).click();
  await page.getByText('units: cameras 3 (held: 2 by watch: watch)').waitFor();
  await stage.capture(page, 'units_held');
  await page.getByRole('link', { name: 'Missions' }).click();
  await button('Start a mission').click();
  await pane.getByLabel('Mission', { exact: true }).selectOption('watch.yaml');
  await pane.getByRole('button', { name: 'Start', exact: true }).click();
  await pane.getByRole('alert').getByText(/the mission was not started: .*segue mission run/).waitFor();
  await stage.capture(page, 'start_refused');
  assert.equal(JSON.parse(stage.run(['mission', 'status', '--format', 'json'])).state, 'running', 'the first one goes on');
  await page.getByRole('group', { name: 'Steer the mission' }).getByRole('button', { name: 'Stop', exact: true }).click();
  await badge('ended: preempted').waitFor();
  await free();
}

/** Without the robot, at once, and for who may command it only. */
async function simulate(page) {
  const { pane, badge, button } = partsOf(page);
  await pane.getByLabel('Mode').selectOption('Concurrent, strict');
  await pane.getByLabel('simulated, at once').check();
  await pane.getByRole('button', { name: 'Simulate' }).click();
  await badge('simulated').waitFor();
  await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
  await stage.capture(page, 'start_simulated');
  assert.equal(happened().length, 2, 'the robot has heard nothing of it');
  await pane.getByLabel('Mission', { exact: true }).selectOption('broken.yaml');
  await pane.getByRole('alert').getByText('nowhere').waitFor();
  await button('Back to the robot').click();
  await badge('ended: preempted').waitFor();
}

/** The run that has ended, and a new one that goes on. */
async function lookBack(page) {
  const { runs, badge, button } = partsOf(page);
  await button('Past runs').click();
  const line = runs.getByRole('button', { name: /watch.*sequential/ });
  await line.getByText('preempted').waitFor();
  await line.click();
  await badge('past run: preempted').waitFor();
  await page.getByText('2 nodes', { exact: true }).waitFor();
  await stage.capture(page, 'past_runs');
  await page.emulateMedia({ colorScheme: 'dark' });
  await stage.capture(page, 'past_runs_dark');
  await page.emulateMedia({ colorScheme: 'light' });
  await page.getByRole('link', { name: 'The robot then' }).click();
  await page.getByRole('complementary', { name: 'At that time' }).getByText('watch', { exact: true }).waitFor();
  await page.getByRole('link', { name: 'Missions' }).click();
  await badge('ended: preempted').waitFor();
}

async function startAgain(page) {
  const { pane, badge, button, runs } = partsOf(page);
  await button('Start a mission').click();
  await pane.getByLabel('Mission', { exact: true }).selectOption('watch.yaml');
  await pane.getByLabel('Mode').selectOption('Concurrent, ahead of time');
  await pane.getByRole('button', { name: 'Start', exact: true }).click();
  await badge('running').waitFor();
  await button('Past runs').click();
  await runs.getByRole('button', { name: /watch.*concurrent/ }).getByText('running').waitFor();
}

/** Who may only look starts nothing, and sees past runs. */
async function observe() {
  const observing = await stage.startStudio('--observe');
  const observer = await stage.browser.newPage();
  await observer.goto(observing.found);
  await observer.getByRole('link', { name: 'Missions' }).click();
  const { runs, button } = partsOf(observer);
  await button('Past runs').click();
  await runs.getByText('preempted').waitFor();
  assert.equal(await button('Start a mission').count(), 0);
  await observer.close();
  await end(observing.child);
}

await stage.play(async () => {
  stage.run(['init', 'rover']);
  appendFileSync(join(stage.folder, 'rover/robot.yaml'), 'units: {cameras: 3}\n');
  writeFileSync(join(stage.folder, 'rover', 'watch.yaml'), watch);
  writeFileSync(join(stage.folder, 'rover', 'broken.yaml'), 'mission: broken\nstart: nowhere\nstates: {}\n');
  await stage.start(['run', 'rover/robot.yaml', '--controller', 'explore'], /robot rover runs/);
  await stage.settled('explore');
  const page = await stage.enter();
  await page.setViewportSize({ width: 1280, height: 800 });
  await page.getByRole('link', { name: 'Missions' }).click();
  await correct(page);
  await run(page);
  await simulate(page);
  await lookBack(page);
  await startAgain(page);
  await observe();

  // The mission ends in order with its studio, also where that is killed.
  await end(stage.studio.child);
  assert.equal(lastOutcome(), 'preempted');
  assert.equal(status().commanded_by, null);
  stage.studio = await stage.startStudio();
  await page.goto(stage.studio.found);
  await page.getByRole('link', { name: 'Missions' }).click();
  await startAgain(page);
  stage.studio.child.kill('SIGKILL');
  await free();
  assert.equal(lastOutcome(), 'preempted');
});
