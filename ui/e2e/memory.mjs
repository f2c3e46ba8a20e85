// SPDX-License-Identifier: Apache-2.0
// Memory of pages that stay open at a robot that switches every second: one page for each view, the studio and the robot.
// Prints a line every minute, and at the end how much each has grown since the first quarter of the time; fails where one has grown
// by more than a tenth and a megabyte.
//   node memory.mjs SEGUE PICTURE_FOLDER [MINUTES]       default: 60
import { spawn } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { figure } from './aims.mjs';
import { addPanel } from './panels.mjs';
import { Stage } from './stage.mjs';

const [segue, pictures, minutes = '60'] = process.argv.slice(2);
const stage = new Stage(segue, pictures);
const views = ['Network', 'Switch', 'Missions', 'Plots', 'Events', 'Edit', 'Past', 'ROS 2'];
const wait = (time) => new Promise((resolve) => setTimeout(resolve, time));

/** Resident memory of a process in MB. */
function residentOf(child) {
  const line = /VmRSS:\s+(\d+) kB/.exec(readFileSync(`/proc/${child.pid}/status`, 'utf8'));
  return Number(line[1]) / 1024;
}

/** What lives in a page after garbage has been collected: MB of JavaScript, and nodes of the document. */
async function livingIn(session) {
  await session.send('HeapProfiler.collectGarbage');
  const { usedSize } = await session.send('Runtime.getHeapUsage');
  const { nodes } = await session.send('Memory.getDOMCounters');
  return { heap: usedSize / 2 ** 20, nodes };
}

async function openViews() {
  const first = await stage.openPage();
  await first.goto(stage.studio.found);
  await first.waitForURL((address) => !address.search.includes('token'));
  const address = first.url();
  const opened = [];
  for (const name of views) {
    const page = name === views[0] ? first : await stage.browser.newPage();
    if (page !== first) await page.goto(address);
    await page.getByRole('link', { name, exact: true }).click();
    opened.push({ name, session: await stage.browser.newCDPSession(page), page });
  }
  await first.locator('.react-flow__node[data-id=drive]').click();
  await first.getByRole('button', { name: 'output velocity' }).click();
  const plots = opened.find((one) => one.name === 'Plots').page;
  await addPanel(plots, { fields: { 'laser.scan': ['ranges'] }, title: 'Scan' });
  await addPanel(plots, { fields: { 'drive.velocity': ['forward', 'turn'] }, title: 'Speed' });
  // The film of a request; and a look at ROS 2.
  await opened.find((one) => one.name === 'Past').page.locator('[data-request]').first().click();
  await opened.find((one) => one.name === 'ROS 2').page.locator('[aria-label="ROS 2"][aria-busy=false]').waitFor();
  return opened;
}

/** Alternates between two controllers, once a second, until `over`. Counts those that were done. */
function switchEverySecond(over) {
  let done = 0;
  const loop = (async () => {
    for (let round = 0; !over(); ++round) {
      const next = wait(1000);
      const child = spawn(segue, ['switch', round % 2 ? 'explore' : 'go_to'], { cwd: stage.folder, env: stage.environment, stdio: 'ignore' });
      done += (await new Promise((resolve) => child.on('exit', resolve))) === 0 ? 1 : 0;
      await next;
    }
  })();
  return { loop, done: () => done };
}

async function measure(opened, processes) {
  const values = new Map();
  for (const one of opened) {
    const { heap, nodes } = await livingIn(one.session);
    values.set(one.name + ' MB', heap);
    values.set(one.name + ' nodes', nodes);
  }
  for (const [name, child] of processes) values.set(name + ' MB', residentOf(child));
  return values;
}

let failed = true;
try {
  stage.run(['init', 'rover']);
  const robot = await stage.start(['run', 'rover/robot.yaml', '--controller', 'explore'], /robot rover runs/);
  const opened = await openViews();
  const processes = [['studio', stage.studio.child], ['robot', robot.child]];
  const end = Date.now() + Number(minutes) * 60_000;
  const switching = switchEverySecond(() => Date.now() >= end);
  const series = [];
  for (let minute = 1; Date.now() < end; ++minute) {
    await wait(Math.min(60_000, end - Date.now()));
    series.push(await measure(opened, processes));
    const shown = [...series.at(-1)].map(([name, value]) => name + ' ' + value.toFixed(name.endsWith('MB') ? 1 : 0));
    console.log(`${minute} min, ${switching.done()} switches: ${shown.join(', ')}`);
  }
  await switching.loop;
  const mean = (part, name) => part.reduce((sum, values) => sum + values.get(name), 0) / part.length;
  const quarter = Math.max(1, Math.floor(series.length / 4));
  console.log('\nfirst quarter -> last quarter');
  for (const name of series[0].keys()) {
    const first = mean(series.slice(0, quarter), name);
    const last = mean(series.slice(-quarter), name);
    const [kind, unit] = name.endsWith('MB') ? [name.slice(0, -3), 'MB'] : [name, ''];
    figure(`${kind}, at first ${first.toFixed(1)}, in the end`, last, unit, { most: Number((1.1 * first + 1).toFixed(1)) });
  }
  failed = false;
} catch (error) {
  console.error(error);
  process.exitCode = 1;
} finally {
  await stage.close(failed);
}
