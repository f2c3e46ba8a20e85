// SPDX-License-Identifier: Apache-2.0
// Measures how fast the page draws the Gantt chart of a large run in Chromium; fails where an aim is missed.
//   node gantt_speed.mjs PAGE_FOLDER [NODES]
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { loadavg, tmpdir } from 'node:os';
import { extname, join, normalize } from 'node:path';
import { chromium } from 'playwright-core';
import { figure, frames } from './aims.mjs';
import { browserProgram } from './stage.mjs';

const [folder, count = '100000'] = process.argv.slice(2);
const nodes = Number(count);
const howOften = 150;
const wanted = { frames: 30, drawing: 2000 }; // with another program on one of two processors
const types = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };

/** A run as `segue mission run --format json` prints it: nodes that begin one after another on thirty lanes, each after one before. */
function largeRun() {
  const ends = Array.from({ length: 30 }, () => 0);
  const list = [];
  let seed = 1;
  const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
  for (let i = 0; i < nodes; ++i) {
    const lane = i % ends.length;
    const start = ends[lane] + 0.05 * random();
    ends[lane] = start + 0.1 + 2 * random();
    const before = i < ends.length ? [] : [{ kind: 'data', node: 'group/node_' + (i - ends.length), subject: 'value', from_s: start - 0.05, until_s: start }];
    list.push({ name: 'group/node_' + i, iteration: 0, start_s: start, end_s: ends[lane], status: i % 97 === 0 ? 'failed' : 'done', outcome: 'success', waited_for: before });
  }
  return JSON.stringify({ name: 'large', makespan_s: Math.max(...ends), nodes: list });
}

const server = createServer((request, response) => {
  const path = join(folder, normalize(request.url === '/' ? 'index.html' : request.url.split('?')[0]));
  if (!existsSync(path)) return response.writeHead(404).end();
  response.writeHead(200, { 'Content-Type': types[extname(path)] ?? 'application/octet-stream' }).end(readFileSync(path));
});
await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));

/** Turns the wheel once in each frame and looks how far apart frames are. */
function turn({ howOften, options }) {
  return new Promise((resolve) => {
    const canvas = document.querySelector('.chart canvas');
    const box = canvas.getBoundingClientRect();
    const times = [];
    const step = (time) => {
      times.push(time);
      if (times.length > howOften) return resolve(times.slice(1).map((at, i) => at - times[i]));
      const there = times.length % 50 < 25 ? 1 : -1;
      canvas.dispatchEvent(new WheelEvent('wheel', {
        bubbles: true, cancelable: true, clientX: box.left + box.width * 0.6, clientY: box.top + 100, ctrlKey: options.zoom, shiftKey: options.pan, deltaY: there * options.delta,
      }));
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  });
}

const scratch = mkdtempSync(join(tmpdir(), 'segue-gantt-'));
let browser = null;
try {
  const file = join(scratch, 'run.json');
  writeFileSync(file, largeRun());
  browser = await chromium.launch({ executablePath: browserProgram(), headless: true, args: ['--no-sandbox', '--disable-gpu'] });
  const page = await browser.newPage({ viewport: { width: 1360, height: 820 } });
  await page.goto('http://127.0.0.1:' + server.address().port + '/#missions');
  const input = page.getByLabel('Open a recorded run');
  await input.waitFor();
  await page.evaluate(() => {
    window.firstDrawing = new Promise((resolve) => {
      document.querySelector('input[type=file]').addEventListener('change', () => {
        const begin = performance.now();
        const check = () => {
          if (document.querySelector('.chart canvas')) requestAnimationFrame(() => requestAnimationFrame((time) => resolve(time - begin)));
          else requestAnimationFrame(check);
        };
        check();
      }, { capture: true });
    });
  });
  await input.setInputFiles(file);
  const report = (name, intervals) => frames(name, intervals, wanted.frames);
  console.log(`${nodes} nodes, ${browser.version()}, load ${loadavg()[0].toFixed(1)}`);
  figure('first drawing, with reading the file', await page.evaluate(() => window.firstDrawing), 'ms', { most: wanted.drawing });
  for (const rows of ['rows that can be read', 'all rows at once']) {
    if (rows === 'all rows at once') await page.getByRole('button', { name: 'all rows' }).click();
    report(rows + ', zoom', await page.evaluate(turn, { howOften, options: { zoom: true, delta: -40 } }));
    report(rows + ', pan in time', await page.evaluate(turn, { howOften, options: { pan: true, delta: 60 } }));
    report(rows + ', scroll', await page.evaluate(turn, { howOften, options: { delta: 400 } }));
  }
} finally {
  await browser?.close();
  server.close();
  rmSync(scratch, { recursive: true, force: true });
}
