// SPDX-License-Identifier: Apache-2.0
// A browser behind a slow connection (slow_link.py), a fast one at the same studio, and a robot with many values. Status 77: there
// is no browser.
//   node slow.mjs SEGUE SCREENSHOT_FOLDER
import { spawn } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';
import assert from 'node:assert/strict';
import { end, Stage } from './stage.mjs';

const stage = new Stage(...process.argv.slice(2));
const scans = 'port/laser/scan'; // of 4096 numbers each: some 75 kB, up to 20 times a second
const slowRate = 100_000; // bytes in a second: a scan takes most of one

/** The robot of `segue init`, with as many distances in a scan as there can be. */
function makeRobot() {
  stage.run(['init', 'rover']);
  for (const name of ['explore', 'manual']) {
    const file = join(stage.folder, 'rover/controllers', name + '.yaml');
    writeFileSync(file, readFileSync(file, 'utf8').replace('"demo::LaserScanner"', '"demo::LaserScanner", properties: {beams: 4096}'));
  }
}

/** A connection to the studio for which `pass` says how many bytes pass in a second. */
async function startLink(studioPort) {
  const child = spawn('python3', [fileURLToPath(new URL('slow_link.py', import.meta.url)), studioPort], { stdio: ['pipe', 'pipe', 'inherit'] });
  stage.running.push(child);
  const port = await new Promise((resolve, reject) => {
    createInterface(child.stdout).once('line', resolve);
    child.once('exit', () => reject(new Error('slow_link.py ended')));
  });
  return { port, pass: (rate) => child.stdin.write(rate + '\n') };
}

/** The updates of documents that a page receives: of each how many, how many it was told to have missed, and how many came without that last. */
function follow(page) {
  const documents = new Map();
  const waiting = new Set();
  page.on('websocket', (socket) => {
    socket.on('framereceived', ({ payload }) => {
      const { document, version, skipped } = JSON.parse(payload);
      if (document === undefined) return;
      const before = of(document);
      const isNext = before.received === 0 || version === before.version + skipped + 1;
      documents.set(document, {
        version, received: before.received + 1, skipped: before.skipped + skipped, inSequence: skipped === 0 ? before.inSequence + 1 : 0,
        areCounted: before.areCounted && isNext,
      });
      for (const check of waiting) check();
    });
  });
  const of = (document) => documents.get(document) ?? { version: 0, received: 0, skipped: 0, inSequence: 0, areCounted: true };
  /** Resolves once `holds` does of what came of the document. */
  const until = (document, holds) => new Promise((resolve, reject) => {
    const late = setTimeout(() => reject(new Error('the page received no more of ' + document + ' than ' + JSON.stringify(of(document)))), 60000);
    const check = () => {
      if (!holds(of(document))) return;
      waiting.delete(check);
      clearTimeout(late);
      resolve();
    };
    waiting.add(check);
    check();
  });
  return { of, until, more: (document, count) => { const { received } = of(document); return until(document, (now) => now.received >= received + count); } };
}

/** Shows the scans of the laser in the view Network; resolves to their text. */
async function showScans(page) {
  await page.locator('.react-flow__node[data-id=laser]').click();
  const panel = page.getByRole('complementary', { name: 'Task laser' });
  await panel.getByRole('button', { name: 'output scan' }).click();
  await panel.locator('.samples pre').waitFor();
  return panel.locator('.samples');
}

const cycles = () => JSON.parse(stage.run(['task', 'drive', '--format', 'json'])).cycles;

/** A page that gets nothing at all holds nobody up. */
async function stall({ link, fast, slow }) {
  link.pass(0);
  const before = cycles();
  await fast.updates.until(scans, ({ version }) => version >= slow.updates.of(scans).version + 40);
  await fast.updates.until('status', ({ version }) => version >= slow.updates.of('status').version + 4);
  assert.ok(cycles() > before, 'the robot goes on');
}

/** What a slow page is told, shows and asks. */
async function goSlowly({ link, fast, slow }) {
  link.pass(slowRate);
  await slow.samples.getByText('updates skipped').waitFor();
  const [few, many] = [slow.updates.of(scans), fast.updates.of(scans)];
  assert.ok(few.skipped > 0);
  assert.ok(few.received < many.received, few.received + ' updates, and ' + many.received + ' of the fast page');

  // It asks the robot, and gets its answer.
  const panel = slow.page.getByRole('complementary', { name: 'Task laser' });
  await panel.getByLabel('max_range').fill('6.5');
  await panel.getByLabel('max_range').press('Enter');
  await panel.locator('output.good', { hasText: 'set' }).waitFor();
  assert.equal(JSON.parse(stage.run(['task', 'laser', '--format', 'json'])).properties.max_range, 6.5);

  // What the fast page does shows here too: the newest, without what was in between.
  await fast.page.getByRole('link', { name: 'Switch' }).click();
  await fast.page.getByRole('button', { name: 'manual', exact: true }).click();
  await fast.page.getByRole('button', { name: 'Switch', exact: true }).click();
  await fast.page.locator('.outcome.good', { hasText: 'done' }).waitFor();
  await slow.page.locator('.react-flow__node[data-id=joystick]').waitFor();
  await slow.page.locator('.react-flow__node[data-id=wanderer]').waitFor({ state: 'detached' });
  await slow.page.getByText('manual, idle').waitFor();
  await stage.capture(slow.page, 'slow');
}

/** Fast again, it gets one update after another, and what it has put together of all is what the robot shows. */
async function recover({ link, fast, slow }) {
  link.pass('all');
  await slow.updates.until(scans, ({ inSequence }) => inSequence >= 10);
  await fast.page.getByRole('link', { name: 'Network' }).click();
  fast.samples = await showScans(fast.page);
  // The robot stands still under this controller, so that both show the same scan.
  const text = (one) => one.samples.locator('pre').innerText();
  const deadline = Date.now() + 60000;
  while ((await text(slow)) !== (await text(fast))) assert.ok(Date.now() < deadline, 'both pages show the same scan');
  await slow.page.getByText('5 tasks, 5 connections').waitFor();
  assert.equal(await slow.page.locator('.banner').count(), 0);
  for (const document of [scans, 'status']) assert.ok(slow.updates.of(document).areCounted, 'it was told of each version of ' + document + ' that it has not got');
}

await stage.play(async () => {
  makeRobot();
  const robot = await stage.start(['run', 'rover/robot.yaml', '--controller', 'explore'], /robot rover runs/);
  const studio = await stage.startStudio();
  const address = new URL(studio.found);
  const link = await startLink(address.port);
  // By one name of the studio the browser comes directly, by another through the link; the studio cannot tell.
  const direct = await stage.openBrowser(`--host-resolver-rules=MAP localhost:${address.port} 127.0.0.1:${link.port}`);
  const fast = { page: direct, updates: follow(direct) };
  await direct.goto(studio.found);
  await direct.waitForURL((reached) => !reached.search.includes('token'));
  const [cookie] = await stage.browser.cookies();
  await stage.browser.addCookies([{ ...cookie, domain: 'localhost' }]);
  const throughLink = stage.watched(await stage.browser.newPage());
  const slow = { page: throughLink, updates: follow(throughLink) };
  const key = await direct.evaluate(() => window.localStorage.getItem('segue-key'));
  await throughLink.goto(`http://localhost:${address.port}/#key=${key}`);
  for (const one of [fast, slow]) one.samples = await showScans(one.page);
  for (const one of [fast, slow]) await one.updates.more(scans, 3);

  await stall({ link, fast, slow });
  await goSlowly({ link, fast, slow });
  await recover({ link, fast, slow });
  assert.equal(await end(studio.child), 0);
  assert.equal(await end(robot.child), 0);
});
