// SPDX-License-Identifier: Apache-2.0
// Plots, a map and an image of a real robot in a real browser. Status 77: there is no browser.
//   node plots.mjs SEGUE SCREENSHOT_FOLDER [seeing]      seeing: with the camera and the map of the simulated rover
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { addPanel as add, coloured, drawn } from './panels.mjs';
import { Stage } from './stage.mjs';

const [segue, pictures, seeing] = process.argv.slice(2);
const stage = new Stage(segue, pictures);

/** The robot of `segue init`; if wanted with a controller for the simulated rover, its camera and its map. */
function makeRobot() {
  stage.run(['init', 'rover']);
  if (!seeing) return;
  const robot = join(stage.folder, 'rover/robot.yaml');
  const libraries = 'segue_components_demo, segue_components_rover, segue_components_navigation]';
  writeFileSync(robot, readFileSync(robot, 'utf8').replace('segue_components_demo]', libraries)
    .replace(/^halt:\n(?: .*\n)*/m, '')); // so that nothing of explore is kept prepared
  const seeingFile = join(stage.folder, 'rover/controllers/seeing.yaml');
  writeFileSync(seeingFile, `network: seeing
tasks:
  rover: {component: "rover::Simulation"}
  wheels: {component: "rover::RoverDrive"}
  camera: {component: "rover::Camera", properties: {camera: room}}
  mapper:
    component: navigation::GridMapper
    properties: {x: -5.0, y: -5.0, width: 10.0, height: 10.0, sensor: {x: 0.40, y: 0.0, theta: 0.0}}
connections:
  - rover.wheel_state -> wheels.measured
  - wheels.wheels -> rover.wheels
  - rover.scene -> camera.scene
  - rover.scan -> mapper.scan
  - wheels.odometry -> mapper.pose
`);
}

/** The documents that the page looks at, as its messages say. */
function follow(page) {
  const looking = new Set();
  page.on('websocket', (socket) => {
    looking.clear();
    socket.on('framesent', ({ payload }) => {
      const { verb, arguments: given } = JSON.parse(payload);
      if (verb === 'subscribe') looking.add(given.document);
      if (verb === 'unsubscribe') looking.delete(given.document);
    });
  });
  const ports = () => [...looking].filter((document) => document.startsWith('port/')).sort();
  /** Waits until the page looks at these ports alone. */
  const only = async (...expected) => {
    for (const deadline = Date.now() + 20000; Date.now() < deadline && ports().join() !== expected.join(); await new Promise((resolve) => setTimeout(resolve, 50)));
    assert.deepEqual(ports(), expected);
  };
  return { ports, only };
}

const panelOf = (page, title) => page.getByRole('region', { name: title, exact: true });

async function addPanels(page, looking) {
  // By the keyboard alone: Enter in the search chooses the first port.
  await page.getByRole('button', { name: 'Add a panel' }).focus();
  await page.keyboard.press('Enter');
  const dialog = page.getByRole('dialog', { name: 'Add a panel' });
  await dialog.getByText('output ports').waitFor();
  await dialog.getByRole('button', { name: 'Add', exact: true, disabled: true, description: 'needs a field of a port' }).waitFor();
  await page.keyboard.type('demo::Velocity drive');
  await dialog.getByText(/^1 of/).waitFor();
  await page.keyboard.press('Enter');
  await dialog.getByLabel('forward').focus();
  await page.keyboard.press('Space');
  await dialog.getByLabel('turn').check();
  assert.ok(await dialog.getByRole('radio', { name: 'plot over time' }).isChecked());
  await stage.capture(page, 'plots_choose');
  await dialog.getByLabel('Title').fill('Speed');
  await page.keyboard.press('Enter');
  await dialog.waitFor({ state: 'detached' });
  assert.deepEqual(looking.ports(), ['port/drive/velocity']);

  await add(page, { fields: { 'odometry.pose': ['the whole sample'], 'laser.scan': ['the whole sample'] }, title: 'Where it is' });
  await add(page, { fields: { 'laser.scan': ['ranges'] }, title: 'Scan', kind: 'profile' });
  await add(page, { fields: { 'odometry.pose': ['x', 'y'], 'laser.scan': ['ranges'] }, title: 'Lines', kind: 'plot over time' });
}

async function usePanels(page, looking) {
  const panel = (title) => panelOf(page, title);
  const speed = panel('Speed');
  await speed.locator('[data-line="0"]', { hasText: /\d/ }).waitFor();
  await drawn(panel('Where it is').locator('canvas'), 4);
  await panel('Where it is').getByText(/x -?\d+\.\d\d m, y/).waitFor();
  await drawn(panel('Scan').locator('canvas'), 2);
  await panel('Lines').getByRole('button', { name: 'laser.scan ranges[1]' }).waitFor();
  await stage.capture(page, 'plots');

  // Zooming pauses, and a paused panel asks for nothing.
  await speed.getByRole('button', { name: 'Zoom in' }).click();
  await speed.getByText('Paused').waitFor();
  assert.ok(!looking.ports().includes('port/drive/velocity'));
  await speed.getByRole('img').focus();
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.press('ArrowLeft');
  await speed.locator('[data-line="0"]', { hasText: /\d/ }).waitFor();
  await speed.getByRole('button', { name: 'Go on with Speed' }).click();
  await speed.getByText('Paused').waitFor({ state: 'detached' });
  assert.ok(looking.ports().includes('port/drive/velocity'));

  // Drag to zoom, hide a line, another window and size.
  const box = await speed.locator('.u-over').boundingBox();
  await page.mouse.move(box.x + box.width * 0.4, box.y + 20);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.8, box.y + 30, { steps: 4 });
  await page.mouse.up();
  await speed.getByText('Paused').waitFor();
  await speed.getByRole('button', { name: 'drive.velocity turn' }).click();
  assert.equal(await speed.getByRole('button', { name: 'drive.velocity turn' }).getAttribute('aria-pressed'), 'false');
  await speed.getByLabel('Time shown in Speed').selectOption('60');
  await speed.getByLabel('Size of Speed').selectOption('2 × 1');
  await speed.getByRole('button', { name: 'Go on with Speed' }).click();

  const map = panel('Where it is');
  await map.getByLabel('follow').check();
  await map.getByRole('button', { name: 'Zoom in' }).click();
  await map.getByRole('img').focus();
  await page.keyboard.press('ArrowUp');
  assert.equal(await map.getByLabel('follow').isChecked(), false);
  await map.getByRole('button', { name: 'All' }).click();
  await panel('Lines').getByRole('button', { name: 'Move Lines earlier' }).click();
}

const titles = (page) => page.locator('.plot-panel h2').allTextContents();

async function keepLayouts(page) {
  const before = await titles(page);
  assert.deepEqual(before.slice(0, 4), ['Speed', 'Where it is', 'Lines', 'Scan']);
  const downloading = page.waitForEvent('download');
  await page.getByRole('button', { name: 'Save to a file' }).click();
  const download = await downloading;
  assert.equal(download.suggestedFilename(), 'rover.layout.json');
  const saved = join(stage.folder, 'saved.json');
  await download.saveAs(saved);
  assert.equal(JSON.parse(readFileSync(saved, 'utf8')).panels[0].columns, 2);

  // The browser has kept it.
  await page.reload();
  await page.locator('.plot-panel').first().waitFor();
  assert.deepEqual(await titles(page), before);

  // Files that are no layouts change nothing.
  const file = page.locator('input[type=file]');
  for (const [text, why] of [
    ['<script>alert(1)</script>', 'not JSON'],
    ['{"segue_layout": 99, "panels": []}', 'version 99'],
    ['{"segue_layout": 1, "panels": [{"kind": "script"}]}', 'panels[0].kind'],
  ]) {
    await file.setInputFiles({ name: '<b>bad</b>.json', mimeType: 'application/json', buffer: Buffer.from(text) });
    await page.getByRole('status').filter({ hasText: '<b>bad</b>.json was not loaded' }).filter({ hasText: why }).waitFor();
    assert.deepEqual(await titles(page), before);
  }
  await file.setInputFiles({ name: 'one.json', mimeType: 'application/json', buffer: Buffer.from('{"segue_layout": 1, "panels": []}') });
  await page.getByText('Loaded one.json.').waitFor();
  assert.deepEqual(await titles(page), []);
  await page.getByRole('button', { name: 'Take back' }).click();
  assert.deepEqual(await titles(page), before);
  await file.setInputFiles(saved);
  await page.getByText('Loaded saved.json.').waitFor();
  assert.deepEqual(await titles(page), before);
}

/** An image and an occupancy grid; the tasks of the other panels have gone. */
async function see(page) {
  stage.run(['switch', 'seeing']);
  await panelOf(page, 'Speed').getByText('drive.velocity: ').waitFor();
  for (const title of ['Lines', 'Scan', 'Where it is']) await page.getByRole('button', { name: 'Remove ' + title }).click();
  await add(page, { fields: { 'camera.image': ['the whole sample'] }, title: 'Camera' });
  await add(page, { fields: { 'wheels.odometry': ['pose pose'], 'mapper.map': ['the whole sample'], 'rover.scan': ['the whole sample'] }, title: 'Seen' });
  await panelOf(page, 'Camera').getByText('640 × 480 pixels').first().waitFor();
  await drawn(panelOf(page, 'Camera').locator('canvas'), 20);
  await panelOf(page, 'Camera').getByText('Large samples: one in').waitFor();
  await panelOf(page, 'Seen').getByText(/x -?\d+\.\d\d m, y/).waitFor();
  await panelOf(page, 'Seen').getByText('Waiting').waitFor({ state: 'detached' });
  // A free cell and what the laser met.
  for (const colour of [[52, 59, 70], [255, 157, 149]]) await coloured(panelOf(page, 'Seen').locator('canvas'), colour);
  await stage.capture(page, 'plots_camera');
}

await stage.play(async () => {
  makeRobot();
  await stage.start(['run', 'rover/robot.yaml', '--controller', 'explore'], /robot rover runs/);
  const page = await stage.openPage();
  const looking = follow(page);
  await page.goto(stage.studio.found);
  await page.waitForURL((address) => !address.search.includes('token'));
  await page.getByRole('link', { name: 'Plots' }).click();
  await page.getByText('No panel yet').waitFor();
  assert.deepEqual(looking.ports(), []);
  await addPanels(page, looking);
  await usePanels(page, looking);
  await keepLayouts(page);

  await page.emulateMedia({ colorScheme: 'dark' });
  await drawn(page.getByRole('region', { name: 'Where it is' }).locator('canvas'), 4);
  await page.getByRole('region', { name: 'Speed' }).locator('[data-line="0"]', { hasText: /\d/ }).waitFor();
  await stage.capture(page, 'plots_dark');

  if (seeing) await see(page);

  // In other views only samples over time are kept, also those of a panel that was paused; they are there afterwards.
  const speed = panelOf(page, 'Speed');
  await speed.getByLabel('Pause Speed').click();
  await speed.getByText('Paused').waitFor();
  await page.getByRole('link', { name: 'Network' }).click();
  await speed.waitFor({ state: 'detached' });
  await looking.only('port/drive/velocity', ...(seeing ? [] : ['port/laser/scan', 'port/odometry/pose']));
  await page.getByRole('link', { name: 'Plots' }).click();
  await speed.locator('[data-line="0"]', { hasText: /\d/ }).waitFor();
  // What no panel shows is not looked at.
  for (const title of await titles(page)) await page.getByRole('button', { name: 'Remove ' + title, exact: true }).click();
  await looking.only();
});
