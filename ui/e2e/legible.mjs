// SPDX-License-Identifier: Apache-2.0
// Graphs of robots and missions of any size can be read: real examples and made-up ones, at 1280 x 800. Status 77: there is no browser.
//   node legible.mjs SEGUE SCREENSHOT_FOLDER EXAMPLES [rover]      rover: with the simulated rover, whose components are built
import { dirname, join } from 'node:path';
import assert from 'node:assert/strict';
import { madeMission, madeNetwork } from './made.mjs';
import { servePage } from './page_server.mjs';
import { end, Stage } from './stage.mjs';

const [segue, pictures, examples, rover] = process.argv.slice(2);
const stage = new Stage(segue, pictures);
const size = { width: 1280, height: 800 };
const leastText = 11;

/** The drawn graph: the smallest text, boxes (`seen`) and all nodes in the pane, and labels that lie on something, and what is cut off. */
function look() {
  const graph = [...document.querySelectorAll('.graph')].pop();
  const pane = graph.getBoundingClientRect();
  const zoom = new DOMMatrix(getComputedStyle(graph.querySelector('.react-flow__viewport')).transform).a;
  const edgeOf = (one) => (one.closest('.react-flow__edge') ?? one).getAttribute('aria-label') ?? one.textContent;
  const rectOf = (one, name) => Object.assign({ name }, JSON.parse(JSON.stringify(one.getBoundingClientRect())));
  const meets = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
  const isIn = (a, b) => a.left >= b.left - 1 && a.top >= b.top - 1 && a.right <= b.right + 1 && a.bottom <= b.bottom + 1;
  const sizes = [...graph.querySelectorAll('.task-box strong, .task-box > span, .place-box, .port, .react-flow__edge-text, .bulk-edges text')]
    .filter((one) => one.textContent !== '' && meets(one.getBoundingClientRect(), pane))
    .map((one) => parseFloat(getComputedStyle(one).fontSize) * zoom);
  const nodes = [...graph.querySelectorAll('.react-flow__node')];
  const boxes = nodes.filter((one) => one.querySelector('.task-box')).map((one) => rectOf(one, one.dataset.id));
  const labels = [...graph.querySelectorAll('.react-flow__edge-textbg, .bulk-edges rect')].map((one) => rectOf(one, edgeOf(one)));
  const paths = [...graph.querySelectorAll('.react-flow__edge-path, .bulk-edges path:not(.arrows)')].map((one) => rectOf(one, edgeOf(one)));
  const faults = [];
  labels.forEach((label, index) => {
    for (const box of boxes) if (meets(label, box)) faults.push('label of ' + label.name + ' on ' + box.name);
    for (const other of labels.slice(0, index)) if (meets(label, other)) faults.push('labels of ' + label.name + ' and ' + other.name);
  });
  const seen = boxes.filter((one) => isIn(one, pane)).map((one) => one.name);
  const inView = nodes.map((one) => rectOf(one, one.dataset.id)).filter((one) => isIn(one, pane)).map((one) => one.name);
  const cut = [...labels, ...paths].filter((one) => !isIn(one, pane)).map((one) => one.name + ' is cut off');
  return { text: Math.min(...sizes), boxes: boxes.length, seen, inView, edges: paths.length, labels: labels.length, faults, cut };
}

/** Waits until the graph is as it should be: its text can be read, nothing lies on anything, and the boxes `shown` are in view. */
async function legible(page, name, { shown = [], least = 1, all = false } = {}) {
  let last = null;
  const isGood = (found) =>
    found.boxes >= least && found.text >= leastText && found.faults.length === 0 && shown.every((id) => found.inView.includes(id)) && (!all || (found.seen.length === found.boxes && found.cut.length === 0));
  for (const deadline = Date.now() + 150000; Date.now() < deadline && !(last && isGood(last)); await new Promise((resolve) => setTimeout(resolve, 100))) {
    last = await page.evaluate(look).catch(() => null); // no graph yet
  }
  await page.screenshot({ path: join(pictures, 'legible_' + name.replace(/\W+/g, '_') + '.png') });
  const text = last && `${name}: text of ${last.text.toFixed(1)} px, ${last.seen.length} of ${last.boxes} boxes in view, ${last.labels} labels at ${last.edges} edges; ${[...last.faults, ...(all ? last.cut : [])].slice(0, 8).join('; ')}`;
  console.log(text);
  if (!last || !isGood(last)) problems.push(text ?? name + ': no graph');
}
const problems = [];

/** The network of a robot, and the switch to another controller. */
async function seeRobot(page, robot, other, switchIs) {
  await page.getByRole('link', { name: 'Network' }).click();
  await legible(page, robot + ' network', { least: 6, all: true });
  await page.getByRole('link', { name: 'Switch' }).click();
  await page.getByRole('button', { name: other, exact: true }).click();
  await page.locator('.react-flow__node').first().waitFor();
  await legible(page, robot + ' switch', switchIs);
}

/** A mission in the editor. */
async function seeEdited(page, file, start) {
  await page.getByRole('link', { name: 'Edit' }).click();
  await page.getByRole('button', { name: file, exact: true }).click();
  await page.getByRole('region', { name: 'Graph of the mission' }).waitFor();
  await legible(page, 'edit ' + file, { shown: ['start:', ...start] });
}

/** A mission that is held before one of its states, and before `beside`, which runs at the same time and could end it. */
async function seeHeld(page, file, state, beside) {
  const mission = await stage.start(['mission', 'run', join(examples, file), '--break', state, '--break', beside], /held before/);
  await page.getByRole('link', { name: 'Missions' }).click();
  await legible(page, 'mission ' + file, { least: 2, shown: ['state:' + state] });
  await page.getByRole('button', { name: 'open all' }).click();
  await legible(page, 'open mission ' + file, { least: 3 });
  await end(mission.child);
}

async function inStudio(robotFile, controller, test) {
  await stage.beside(join(examples, robotFile), controller, async (page) => {
    await page.setViewportSize(size);
    await test(page);
  });
}

/** Where the window becomes narrow, a network is laid out and folded anew, also while one of its tasks is selected, which stays in view. */
async function narrow(page, address, shown) {
  shown.status = madeNetwork(24, 36, 6);
  await page.setViewportSize({ width: 1920, height: 1080 });
  await page.goto('about:blank');
  await page.goto(address + '#network');
  await legible(page, 'wide network', { least: 24, all: true });
  await page.setViewportSize({ width: 760, height: 800 });
  await legible(page, 'narrow network', { least: 5, all: true });
  await page.goto('about:blank');
  await page.setViewportSize({ width: 1920, height: 1080 });
  await page.goto(address + '#network');
  const task = page.locator('.task-box', { hasText: 'task' }).first();
  await task.click();
  await legible(page, 'wide network with a selection', { least: 24 });
  const chosen = await page.locator('.react-flow__node', { has: page.locator('.task-box.selected') }).getAttribute('data-id');
  await page.setViewportSize({ width: 760, height: 800 });
  await legible(page, 'narrow network with a selection', { least: 5, shown: [chosen], all: true });
  assert.ok(await page.getByRole('complementary').isVisible());
  assert.equal(await page.locator('.react-flow__node', { has: page.locator('.task-box.selected') }).getAttribute('data-id'), chosen);
  await page.setViewportSize(size);
}

/** Made-up networks and missions, which need no robot. */
async function seeMade() {
  const shown = { status: null, mission: null };
  const server = await servePage(join(dirname(segue), '../share/segue/studio'), 'made', (document, send) => shown[document] && send({ document, version: 1, value: shown[document] }));
  const page = await stage.openBrowser();
  await page.setViewportSize(size);
  for (const count of [10, 30, 60, 300]) {
    shown.status = madeNetwork(count, 1.5 * count, Math.ceil(count / 5));
    await page.goto('about:blank');
    await page.goto(server.address + '#network');
    await legible(page, 'network of ' + count, { least: 5, all: true });
  }
  await narrow(page, server.address, shown);
  for (const count of [10, 30, 60]) {
    shown.mission = madeMission(count);
    await page.goto('about:blank');
    await page.goto(server.address + '#missions');
    await legible(page, 'mission of ' + count, { least: 5, shown: ['state:' + shown.mission.entries[1].action] });
  }
  await stage.browser.close();
  server.close();
}

async function seeRover() {
  await inStudio('08_rover/robot.yaml', 'explore', async (page) => {
    await seeRobot(page, 'rover', 'grasp', { least: 16 });
    await seeEdited(page, 'fetch_box.yaml', ['state:guarded/watch']);
    await seeHeld(page, '08_rover/fetch_box.yaml', 'guarded/watch', 'guarded/work');
  });
  await inStudio('08_rover/table_robot.yaml', '', async (page) => {
    await seeEdited(page, 'clear_table.yaml', []);
    await seeHeld(page, '08_rover/clear_table.yaml', 'guarded/watch', 'guarded/work');
  });
}

await stage.play(async () => {
  await seeMade();
  await inStudio('04_artemis/robot.yaml', 'search_explore', (page) => seeRobot(page, 'artemis', 'manipulation', { least: 9, all: true }));
  if (rover) await seeRover();
  assert.deepEqual(problems, []);
});
