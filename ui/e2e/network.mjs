// SPDX-License-Identifier: Apache-2.0
// The view Network of a real robot with several processes in a real browser. Status 77: there is no browser.
//   node network.mjs SEGUE SCREENSHOT_FOLDER
import { writeFileSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { Stage } from './stage.mjs';

const [segue, pictures] = process.argv.slice(2);
const stage = new Stage(segue, pictures);

/** The robot of `segue init`, with the sensors in one process and the drive in another. */
function makeRobot() {
  stage.run(['init', 'rover']);
  const file = join(stage.folder, 'rover/controllers/go_to.yaml');
  const deployments = 'deployments:\n  sensors: {tasks: [laser, odometry]}\n  base: {tasks: [drive]}\n';
  writeFileSync(file, readFileSync(file, 'utf8').trimEnd() + '\n' + deployments);
}

async function holds(what, message) {
  const end = Date.now() + 30000;
  while (!(await what())) {
    assert.ok(Date.now() < end, message);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

/** Boxes that an edge crosses although it belongs to none of their tasks, as the page draws both. */
function crossings(page) {
  return page.evaluate(() => {
    const boxes = [...document.querySelectorAll('.react-flow__node')]
      .filter((node) => node.querySelector('.task-box'))
      .map((node) => ({ id: node.dataset.id, box: node.getBoundingClientRect() }));
    const found = [];
    for (const edge of document.querySelectorAll('.react-flow__edge')) {
      const path = edge.querySelector('path');
      const matrix = path.getScreenCTM();
      const length = path.getTotalLength();
      const margin = 3 * matrix.a; // an arrow ends at its task
      for (let at = 0; at <= 200; ++at) {
        const { x, y } = path.getPointAtLength((length * at) / 200).matrixTransform(matrix);
        for (const { id, box } of boxes) {
          const inside = x > box.left + margin && x < box.right - margin && y > box.top + margin && y < box.bottom - margin;
          if (inside && !found.includes(edge.dataset.id + ' over ' + id)) found.push(edge.dataset.id + ' over ' + id);
        }
      }
    }
    return { found, edges: document.querySelectorAll('.react-flow__edge path').length };
  });
}

async function withoutCrossings(page, name) {
  let last = [];
  await holds(async () => {
    const { found, edges } = await crossings(page);
    last = found;
    return edges > 0 && found.length === 0; // while a new layout is awaited they may touch
  }, name).catch(() => assert.fail(name + ': ' + (last.join(', ') || 'no edges')));
}

const node = (page, id) => page.locator(`.react-flow__node[data-id="${id}"]`);

/** Edges go around tasks, also those that run backwards. */
async function seeRoutes(page) {
  await page.getByText('5 tasks, 6 connections').waitFor();
  await node(page, 'seeker').waitFor();
  await withoutCrossings(page, 'network');
  await page.getByRole('link', { name: 'Switch' }).click();
  await page.getByRole('button', { name: 'manual', exact: true }).click();
  await node(page, 'joystick').waitFor();
  await withoutCrossings(page, 'switch');
  await page.getByRole('link', { name: 'Edit' }).click();
  await page.getByRole('button', { name: 'controllers/go_to.yaml' }).click();
  await node(page, 'seeker').waitFor();
  await withoutCrossings(page, 'edit');
  await page.getByRole('link', { name: 'Network' }).click();
}

/** Processes fold and unfold by mouse and keyboard, and a search opens what it jumps to. */
async function fold(page) {
  const [host, sensors, base] = ['host:localhost', 'group:localhost / sensors', 'group:localhost / base'];
  await node(page, sensors).focus();
  await page.keyboard.press('Enter');
  await node(page, sensors).getByText('2 tasks').waitFor();
  await node(page, 'laser').waitFor({ state: 'detached' });
  await withoutCrossings(page, 'folded');
  await page.getByRole('button', { name: 'fold all', exact: true }).click();
  await node(page, host).getByText('3 tasks').waitFor();
  await node(page, 'seeker').waitFor({ state: 'detached' });
  await page.locator('.react-flow__edge', { hasText: '×2' }).waitFor({ state: 'attached' });
  await stage.capture(page, 'network_folded');
  await page.getByPlaceholder('Find tasks').fill('laser');
  await page.getByPlaceholder('Find tasks').press('Enter');
  await node(page, 'laser').waitFor();
  await page.getByRole('complementary', { name: 'Task laser' }).waitFor();
  await node(page, base).getByText('1 task').waitFor(); // stays folded
  await page.keyboard.press('Escape');
  await page.getByRole('button', { name: 'unfold all' }).click();
  await node(page, 'drive').waitFor();
  await page.getByPlaceholder('Find tasks').fill('');
}

/** The panel of a task says how long its updates took, as drawing and as table. */
async function seeTiming(page) {
  await node(page, 'laser').click();
  const timing = page.getByRole('complementary', { name: 'Task laser' }).getByRole('region', { name: 'Timing' });
  await timing.getByRole('img', { name: /^Updates: half within .* µs, 99 % within/ }).waitFor();
  await timing.getByRole('img', { name: /^Latencies: half within/ }).waitFor();
  await timing.getByText('as a table').first().click();
  const counts = await timing.locator('table').first().locator('td.number').allTextContents();
  assert.ok(counts.length > 0 && counts.every((count) => /^\d+$/.test(count)), 'counts: ' + counts);
  await timing.getByText('as a table').last().scrollIntoViewIfNeeded();
  await stage.capture(page, 'network_timing');
  await page.keyboard.press('Escape');
}

/** What a task logs stands among the events that name it, and the link to all of them searches for it. */
async function seeLog(page) {
  for (let i = 0; i < 15; ++i) stage.run(['call', 'odometry.reset']); // more than there is room for
  await node(page, 'odometry').click();
  const log = page.getByRole('complementary', { name: 'Task odometry' }).getByRole('region', { name: 'Log' });
  await log.getByRole('listitem').filter({ hasText: 'info: the pose was reset' }).last().waitFor();
  await log.getByRole('listitem').filter({ hasText: /start odometry/ }).waitFor();
  const texts = await log.getByRole('listitem').allTextContents();
  assert.match(texts.at(-1), /the pose was reset/, 'the newest comes last');
  const list = log.getByRole('list', { name: 'Log and events, the newest last' });
  await holds(() => list.evaluate((at) => at.scrollTop > 0 && at.scrollTop + at.clientHeight > at.scrollHeight - 4), 'the newest are not in view');
  await log.getByText('segue log sensors').waitFor();
  await log.getByRole('link').scrollIntoViewIfNeeded();
  await stage.capture(page, 'network_log');
  await log.getByRole('link', { name: 'Older ones and search' }).click();
  assert.equal(await page.getByPlaceholder('Find events').inputValue(), 'odometry');
  await page.getByRole('cell', { name: 'start odometry' }).first().waitFor();
  await page.getByRole('link', { name: 'Network' }).click();
  await node(page, 'odometry').waitFor();
}

/** Edges and the panel of a task say how long samples took, within a process and between two. */
async function seeLatencies(page) {
  await page.locator('.react-flow__edge', { hasText: /\/s, [\d.]+ [µm]?s/ }).first().waitFor({ state: 'attached' });
  await node(page, 'drive').click();
  const connections = page.getByRole('complementary', { name: 'Task drive' }).getByRole('region', { name: 'Connections' });
  const measured = connections.getByRole('listitem').filter({ hasText: /latency [\d.]+ [µm]?s, [\d.]+ [µm]?s at the most/ });
  await measured.filter({ hasText: '→ drive.' }).first().waitFor();
  await measured.filter({ hasText: 'drive.velocity → odometry.velocity' }).waitFor();
  await stage.capture(page, 'network_latency');
  await page.keyboard.press('Escape');
}

await stage.play(async () => {
  makeRobot();
  await stage.start(['run', 'rover/robot.yaml', '--controller', 'go_to'], /robot rover runs/);
  const page = await stage.enter();
  await seeRoutes(page);
  await fold(page);
  await seeLatencies(page);
  await seeTiming(page);
  await seeLog(page);
  await page.emulateMedia({ colorScheme: 'dark' });
  await node(page, 'odometry').click();
  await page.getByRole('img', { name: /^Updates: half within/ }).scrollIntoViewIfNeeded();
  await stage.capture(page, 'network_dark');
});
