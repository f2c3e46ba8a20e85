// SPDX-License-Identifier: Apache-2.0
// The view ROS 2 of a robot beside simulated nodes, in a real browser. Status 77: there is no browser.
//   node ros2.mjs SEGUE SCREENSHOT_FOLDER ROS2_NODE_PROGRAM
import { copyFileSync, mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { lookAt } from './screens.mjs';
import { end, Stage } from './stage.mjs';

const [segue, pictures, program] = process.argv.slice(2);
if (!program) {
  console.log('skipped: the simulated nodes are not built');
  process.exit(77);
}
const stage = new Stage(segue, pictures);
const hostile = '<img src=x onerror="window.hostile = true">';

const robot = 'robot: scout\nlibraries: [segue_components_ros2, segue_components_demo]\ncontrollers: [controllers/*.yaml]\n';
const network = `network: scout
tasks:
  front.lidar: {component: ros2::ManagedNode, properties: {name: /lidar, timeout: 100s}}
  voice: {component: ros2::Publisher, properties: {topic: /words, type: std_msgs/msg/String, reliability: best_effort}}
  drive: {component: "demo::Drive"}
  exposure: {component: ros2::Exposure, properties: {namespace: /scout}}
deployments:
  ros2: {tasks: [front.lidar, voice, exposure]}
`;
const parameters = '/lidar:\n  ros__parameters: ' + JSON.stringify({ rate: 10, frame: hostile, counts_on: '/scan', every: 0.1 }) + '\n';

/** Starts a node as a program of the package `scout`. */
function startNode(name, ...more) {
  const file = join(stage.folder, 'ros2/lib/scout', name);
  copyFileSync(program, file);
  return stage.launch(file, ['--ros-args', '-r', '__node:=' + name, ...more]);
}

function makeRobot() {
  mkdirSync(join(stage.folder, 'controllers'));
  mkdirSync(join(stage.folder, 'ros2/lib/scout'), { recursive: true });
  writeFileSync(join(stage.folder, 'robot.yaml'), robot);
  writeFileSync(join(stage.folder, 'controllers/scout.yaml'), network);
  writeFileSync(join(stage.folder, 'lidar.yaml'), parameters);
}

const nodes = (page) => page.getByRole('region', { name: 'Nodes of ROS 2' });
const line = (page, name) => nodes(page).locator('a.line', { hasText: name });
const node = (page, name) => page.getByRole('region', { name: 'Node ' + name });

/** Looks again and again until something is there, since nodes tell of themselves when they like to. */
async function lookUntil(page, what) {
  const view = page.getByRole('region', { name: 'ROS 2', exact: true });
  for (let looks = 1; ; ++looks) {
    await view.and(page.locator('[aria-busy=false]')).waitFor();
    if ((await what.count()) > 0) return;
    assert.ok(looks < 30, 'it is not seen: ' + what);
    await page.getByRole('button', { name: 'Look again' }).click();
  }
}

/** On all screens; and takes a picture. */
async function looksWell(page, name) {
  assert.deepEqual(await lookAt(stage, page, name), []);
  await page.setViewportSize({ width: 1360, height: 820 });
  await stage.capture(page, name);
}

async function nobody(page) {
  await page.getByRole('link', { name: 'ROS 2' }).waitFor();
  await page.keyboard.press('8');
  await page.locator('.empty', { hasText: 'They tell of themselves' }).waitFor();
  await page.locator('.empty', { hasText: 'No node was found in domain ' + stage.environment.ROS_DOMAIN_ID }).waitFor();
  await stage.capture(page, 'ros2_nobody');
}

async function listed(page) {
  await lookUntil(page, line(page, '/lidar').filter({ hasText: 'active' }));
  await lookUntil(page, line(page, '/scout/drive').filter({ hasText: 'active' }));
  await lookUntil(page, line(page, '/listener'));
  await line(page, '/lidar').filter({ hasText: /(?<!is )task front.lidar/ }).waitFor();
  await line(page, '/scout/drive').filter({ hasText: 'is task drive' }).waitFor();
  await lookUntil(page, page.getByRole('row').filter({ hasText: '/listener gets nothing from /voice: reliability: best_effort is offered, reliable is requested' }));
  await page.getByText(/domain \d+: \d+ nodes, \d+ topics, as of \d\d:\d\d:\d\d/).waitFor();
  await looksWell(page, 'ros2_topics');
}

async function described(page) {
  await line(page, '/lidar').click();
  const lidar = node(page, '/lidar');
  await lidar.getByText(/process: scout lidar \(\d+\)/).waitFor();
  await lidar.getByRole('region', { name: 'Parameters' }).getByRole('row', { name: /^rate 10 integer/ }).waitFor();
  await lidar.getByRole('region', { name: 'Parameters' }).getByText(hostile).waitFor();
  await lidar.getByRole('region', { name: 'Publishes' }).getByRole('row', { name: /\/scan std_msgs\/msg\/UInt64 reliable, volatile/ }).waitFor();
  await lidar.getByText('As a task of a network').click();
  await lidar.getByText('component: ros2::ManagedNode').waitFor();
  await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
  await lidar.getByRole('button', { name: 'Copy' }).click();
  await lidar.getByText('copied').waitFor();
  assert.match(await page.evaluate(() => navigator.clipboard.readText()), /^# .*\ntasks:\n(.*\n)*  lidar:\n    component: ros2::ManagedNode\n/);
  assert.equal(await page.evaluate(() => window.hostile), undefined);
  await lidar.getByLabel('Network to add it to').waitFor();
  await looksWell(page, 'ros2_node');
}

/** The node as a task of the network that is edited; nothing is saved. */
async function added(page) {
  const lidar = node(page, '/lidar');
  await lidar.getByLabel('Network to add it to').selectOption('controllers/scout.yaml');
  await lidar.getByRole('button', { name: 'Add to' }).click();
  await lidar.getByText('added as lidar, not saved yet').waitFor();
  await lidar.getByRole('link', { name: 'edit controllers/scout.yaml' }).click();
  const edit = page.getByRole('region', { name: 'Edit controllers/scout.yaml' });
  await edit.getByText('unsaved changes').waitFor();
  await edit.locator('.react-flow__node[data-id=lidar]').waitFor();
  await edit.getByRole('button', { name: 'Undo' }).click();
  await edit.getByText('as in the file').waitFor();
  await page.goBack();
  await lidar.waitFor();
}

/** From a node to its task, and back. */
async function follow(page) {
  await node(page, '/lidar').getByRole('link', { name: 'front.lidar' }).click();
  const panel = page.getByRole('complementary', { name: 'Task front.lidar' });
  await panel.getByRole('link', { name: '/lidar' }).click();
  await node(page, '/lidar').waitFor();
  await page.keyboard.press('Escape');
  await page.getByRole('region', { name: 'Topics' }).waitFor();
  await page.keyboard.press('/');
  await page.keyboard.type('listener');
  await line(page, '/scout/drive').waitFor({ state: 'detached' });
  await page.getByRole('row', { name: /^\/words/ }).getByRole('link', { name: '/listener' }).click();
  await node(page, '/listener').getByText('No task of the robot that runs stands for it.').waitFor();
  await node(page, '/listener').getByText('/listener gets nothing from /voice').waitFor();
}

/** A node that ends is not found any more; a robot that ends cannot be asked where to look. */
async function gone(page, listener, running) {
  await end(listener);
  await lookUntil(page, page.locator('.empty', { hasText: 'has not found the node /listener' }));
  await stage.capture(page, 'ros2_gone');
  await end(running.child);
  await page.getByText('The robot cannot be reached').waitFor();
  await page.getByRole('button', { name: 'Look again' }).click();
  await page.getByRole('alert').filter({ hasText: /The look failed: .*What is shown is of the one before/ }).waitFor();
}

await stage.play(async () => {
  makeRobot();
  const running = await stage.start(['run', 'robot.yaml'], /robot scout runs/);
  const page = await stage.enter();
  await nobody(page);
  startNode('lidar', '--params-file', join(stage.folder, 'lidar.yaml'));
  const listener = startNode('listener');
  stage.run(['switch', 'scout']);
  await listed(page);
  await described(page);
  await added(page);
  await follow(page);
  await gone(page, listener, running);
});
