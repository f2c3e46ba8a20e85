// SPDX-License-Identifier: Apache-2.0
// Measures how fast the page draws a large network in Chromium, of a made-up robot whose values change twice a second;
// fails where an aim is missed.
//   node network_speed.mjs PAGE_FOLDER [TASKS [CONNECTIONS]]
import { loadavg } from 'node:os';
import { chromium } from 'playwright-core';
import { figure, frames } from './aims.mjs';
import { madeNetwork } from './made.mjs';
import { servePage } from './page_server.mjs';
import { browserProgram } from './stage.mjs';

const [folder, taskCount = '1000', connectionCount = '5000'] = process.argv.slice(2);
const counts = { tasks: Number(taskCount), connections: Number(connectionCount) };
const howOften = 120;
const wanted = { frames: 30, drawing: 3000, opening: 5000 }; // with another program on one of two processors
const [hosts, processesOfHost] = [10, 5];

const status = madeNetwork(counts.tasks, counts.connections, hosts * processesOfHost);
const changes = (step) => ({
  set: { uptime_s: 1 + step / 2 },
  in: {
    tasks: { in: Object.fromEntries(Object.keys(status.tasks).map((id, i) => [id, { set: { cycles: step * 50, cycle_us: 1 + ((i + step) % 7) } }])) },
    connections: { in: Object.fromEntries(Object.keys(status.connections).map((key) => [key, { set: { written: step * 50, read: step * 50 } }])) },
  },
});

let size = 0;
const server = await servePage(folder, 'large', (document, send) => {
  if (document !== 'status') return undefined;
  let version = 1;
  send({ document, version, value: status });
  const timer = setInterval(() => {
    const message = { document, version: ++version, change: changes(version) };
    size = JSON.stringify(message).length;
    send(message);
  }, 500);
  return () => clearInterval(timer);
});

/** Drags or turns the wheel once in each frame and looks how far apart frames are. */
function act({ howOften, zoom }) {
  return new Promise((resolve) => {
    const pane = document.querySelector('.graph .react-flow__pane');
    const box = pane.getBoundingClientRect();
    const middle = { x: box.left + box.width / 2, y: box.top + box.height / 2 };
    const times = [];
    const mouse = (type, target, offset) =>
      target.dispatchEvent(new MouseEvent(type, { bubbles: true, cancelable: true, view: window, button: 0, buttons: 1, clientX: middle.x + offset, clientY: middle.y + offset / 3 }));
    if (!zoom) mouse('mousedown', pane, 0);
    const step = (time) => {
      times.push(time);
      const there = times.length % 40 < 20 ? times.length % 20 : 20 - (times.length % 20);
      if (times.length > howOften) {
        if (!zoom) mouse('mouseup', window, 0);
        return resolve(times.slice(1).map((at, i) => at - times[i]));
      }
      if (zoom) pane.dispatchEvent(new WheelEvent('wheel', { bubbles: true, cancelable: true, view: window, clientX: middle.x, clientY: middle.y, deltaY: times.length % 40 < 20 ? -30 : 30 }));
      else mouse('mousemove', window, there * 12);
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  });
}

let browser = null;
try {
  browser = await chromium.launch({ executablePath: browserProgram(), headless: true, args: ['--no-sandbox', '--disable-gpu'] });
  const page = await browser.newPage({ viewport: { width: 1360, height: 820 } });
  page.setDefaultTimeout(120000);
  page.on('pageerror', (error) => console.error(String(error)));
  const report = (name, intervals) => frames(name, intervals, wanted.frames);
  const shape = async (name) => {
    const drawn = await page.evaluate(() => ['.react-flow__node', '.react-flow__edge'].map((one) => document.querySelectorAll(one).length));
    console.log(`${name}: ${drawn[0]} boxes and ${drawn[1]} edges in the page`);
  };
  const measure = async (name) => {
    await shape(name);
    report(name + ', pan', await page.evaluate(act, { howOften, zoom: false }));
    report(name + ', zoom', await page.evaluate(act, { howOften, zoom: true }));
  };
  console.log(`${counts.tasks} tasks and ${counts.connections} connections, ${browser.version()}, load ${loadavg()[0].toFixed(1)}`);
  await page.addInitScript(() => {
    window.firstDrawing = new Promise((resolve) => {
      const check = () => {
        if (document.querySelector('.react-flow__node')) requestAnimationFrame(() => requestAnimationFrame(resolve));
        else requestAnimationFrame(check);
      };
      check();
    });
  });
  await page.goto(server.address + '#network');
  figure('first drawing after the page was asked for', await page.evaluate(() => window.firstDrawing), 'ms', { most: wanted.drawing });
  await measure('all folded');

  // Two hosts with a fifth of the tasks, opened from the keyboard, and their processes.
  const perPlace = Math.ceil(counts.tasks / (hosts * processesOfHost));
  const opened = [];
  const open = async (id, inside) => {
    await page.getByRole('button', { name: 'Fit View' }).click();
    const begin = performance.now();
    await page.locator(`.react-flow__node[data-id="${id}"]`).press('Enter');
    await page.locator(`.react-flow__node[data-id="${inside}"]`).waitFor({ state: 'attached' });
    opened.push(performance.now() - begin);
  };
  for (const host of [0, 1]) {
    const places = Array.from({ length: processesOfHost }, (_, i) => host * processesOfHost + i);
    const group = (place) => `group:host_${host} / process_${place}`;
    await open('host:host_' + host, group(places[0]));
    for (const place of places) await open(group(place), 'task_' + place * perPlace);
  }
  figure('opening a host or process, the slowest', Math.max(...opened), 'ms', { most: wanted.opening });
  await page.getByRole('button', { name: 'Fit View' }).click();
  await measure('two hosts unfolded');
  await page.getByPlaceholder('Find tasks').fill('task_' + (counts.tasks - 1));
  const begin = performance.now();
  await page.getByPlaceholder('Find tasks').press('Enter');
  await page.locator(`.react-flow__node[data-id="task_${counts.tasks - 1}"]`).waitFor();
  figure('jump to a task in a folded host', performance.now() - begin, 'ms', { most: wanted.opening });
  console.log(`each change of all values: ${(size / 1000).toFixed(0)} kB`);
} finally {
  await browser?.close();
  server.close();
}
