// SPDX-License-Identifier: Apache-2.0
// A switch that is cancelled, in a real browser beside a real robot. Status 77: there is no browser.
//   node switch.mjs SEGUE SCREENSHOT_FOLDER
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { Stage } from './stage.mjs';

const [segue, pictures] = process.argv.slice(2);
const stage = new Stage(segue, pictures);
const status = () => JSON.parse(stage.run(['status', '--format', 'json']));

/** The page shows of a switch what the command line does, before anything happens. */
async function planASwitch(page) {
  await page.getByRole('link', { name: 'Switch' }).click();
  await page.getByRole('button', { name: 'go_to', exact: true }).click();
  const panel = page.getByRole('complementary', { name: 'Transition' });
  const commanded = JSON.parse(stage.run(['switch', 'go_to', '--dry-run', '--format', 'json']));
  await panel.getByText(`${commanded.counts.total} actions, ${commanded.counts.state_changes} of them state changes; order seamless`).waitFor();
  const changes = await panel.getByRole('region', { name: 'Changes' }).getByRole('listitem').allInnerTexts();
  assert.deepEqual(changes, commanded.changes.map((change) => change.replaceAll(' -> ', ' → ')));
  const actions = await panel.locator('[data-progress]').allInnerTexts();
  assert.deepEqual(actions.map((text) => Number(/\d+/.exec(text)[0])), commanded.actions.map((action) => action.id));
  assert.ok(actions.some((text) => text.includes('(circular_buffer of 4)')), actions.join('\n'));
  await panel.getByRole('row', { name: /^total( [\d.]+ (µs|ms|s)){3}$/ }).waitFor();
  const size = page.viewportSize();
  await page.setViewportSize({ width: 1280, height: 800 });
  await stage.capture(page, 'switch_planned');
  await page.setViewportSize(size);
}

async function cancelASwitch(page) {
  await page.getByRole('link', { name: 'Switch' }).click();
  await page.getByRole('button', { name: 'go_to', exact: true }).click();
  await page.locator('.task-box.fate-added').first().waitFor();
  await page.getByText('Force kills the processes').waitFor();
  await page.getByRole('button', { name: 'Switch', exact: true }).click();
  // What is done quickly is done; the slow task lets the transition wait.
  await page.locator('[data-progress=done]', { hasText: 'configure seeker' }).waitFor();
  const cancel = page.getByRole('button', { name: 'Cancel go_to' });
  await cancel.focus();
  await page.keyboard.press('Enter');
  await page.getByText(/cancelled by segue studio/).first().waitFor();
  await page.locator('.outcome', { hasText: 'cancelled' }).waitFor();
  const undo = page.getByRole('region', { name: 'Undo' });
  await undo.locator('[data-undo=done]', { hasText: 'cleanup seeker' }).waitFor();
  await page.locator('[data-progress=undone]', { hasText: 'configure seeker' }).waitFor();
  await cancel.waitFor({ state: 'detached' });
  await stage.capture(page, 'switch_cancelled');
  assert.equal(status().controller, 'explore');
  assert.deepEqual(status().requests, []);

  // One that somebody else asked for.
  const switching = stage.start(['switch', 'go_to'], /cancelled/);
  await cancel.click();
  await switching;
  await cancel.waitFor({ state: 'detached' });
  assert.equal(status().controller, 'explore');
}

await stage.play(async () => {
  stage.run(['init', 'rover']);
  // Without its libraries it has stand-ins, one of which takes its time.
  const robot = join(stage.folder, 'rover/robot.yaml');
  writeFileSync(robot, readFileSync(robot, 'utf8').replace(/^libraries.*$/m, ''));
  writeFileSync(join(stage.folder, 'slow.yaml'), 'stand_ins: {guard: {configure: 3s}, default: {rate: 1}}\n');
  await stage.start(['run', 'rover/robot.yaml', '--controller', 'explore', '--stand-ins', 'slow.yaml'], /robot rover runs/);
  await stage.settled('explore');
  const page = await stage.enter();
  await planASwitch(page);
  await cancelASwitch(page);
  await page.emulateMedia({ colorScheme: 'dark' });
  await stage.capture(page, 'switch_cancelled_dark');
});
