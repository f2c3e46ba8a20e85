// SPDX-License-Identifier: Apache-2.0
// Measures what viewers cost: the shares of a core that a robot and its studio take, without and with browsers that look at what
// the views look at, while controllers switch. Fails where an aim is missed.
//   node viewers.mjs SEGUE [VIEWERS [SECONDS [ROBOT_FILE CONTROLLER...]]]       without a robot file: that of `segue init`
// The viewers are small pages that keep what they receive, since ten whole pages would take the processor themselves.
import { readFileSync } from 'node:fs';
import { loadavg } from 'node:os';
import { resolve } from 'node:path';
import { execFileSync } from 'node:child_process';
import { figure } from './aims.mjs';
import { Stage } from './stage.mjs';

const [segue, viewers = '10', seconds = '60', file, ...named] = process.argv.slice(2);
const stage = new Stage(segue, process.env.TMPDIR ?? '/tmp');
const robotFile = file ? resolve(file) : 'rover/robot.yaml';
const controllers = named.length > 0 ? named : ['explore', 'go_to', 'manual'];
const ticks = Number(execFileSync('getconf', ['CLK_TCK'], { encoding: 'utf8' }));
const wanted = { studio: 5, robot: 5 }; // % of a core that ten viewers cost at the most
const documents = ['status', 'events', 'mission'];

/** Processor time of a process, in seconds (proc(5): utime and stime). */
function cpuOf(pid) {
  const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').replace(/^.*\) /, '').split(' ');
  return (Number(fields[11]) + Number(fields[12])) / ticks;
}

/** Switches once a second; prints and returns the shares of a core of both processes, in %. */
async function watch(name, robot, studio) {
  const begin = performance.now();
  const before = [cpuOf(robot.pid), cpuOf(studio.pid)];
  let switches = 0;
  while (performance.now() - begin < 1000 * Number(seconds)) {
    stage.run(['switch', controllers[switches++ % controllers.length]]);
    await new Promise((done) => setTimeout(done, Math.max(0, begin + 1000 * switches - performance.now())));
  }
  const wall = (performance.now() - begin) / 1000;
  const shares = { robot: (100 * (cpuOf(robot.pid) - before[0])) / wall, studio: (100 * (cpuOf(studio.pid) - before[1])) / wall };
  console.log(`${name}: robot ${shares.robot.toFixed(1)} %, studio ${shares.studio.toFixed(1)} % of a core (${switches} switches in ${wall.toFixed(0)} s, load ${loadavg()[0].toFixed(1)})`);
  return shares;
}

/** Connects as a page does, and looks at documents; counts what comes. */
function connect({ address, key, looked }) {
  return new Promise((done, failed) => {
    const socket = new WebSocket(address, ['segue.studio', 'key.' + key]);
    window.received = { messages: 0, bytes: 0 };
    socket.onopen = () => {
      looked.forEach((document, id) => socket.send(JSON.stringify({ id, verb: 'subscribe', arguments: { document } })));
      done();
    };
    socket.onmessage = ({ data }) => {
      ++window.received.messages;
      window.received.bytes += data.length;
    };
    socket.onerror = () => failed(new Error('the studio refused a viewer'));
  });
}

let failed = true;
try {
  if (!file) stage.run(['init', 'rover']);
  const { child: robot } = await stage.start(['run', robotFile, '--controller', controllers[0]], /robot \S+ runs/);
  const first = await stage.openPage();
  await first.goto(stage.studio.found);
  await first.locator('nav').waitFor();
  // A file of the page is a place from which a viewer may connect, without the page's own viewer.
  const { file: place, address, key } = await first.evaluate(() => ({
    file: document.querySelector('link[rel=stylesheet]').href, address: window.location.origin.replace('http', 'ws') + '/socket',
    key: window.localStorage.getItem('segue-key'),
  }));
  await first.goto('about:blank');
  const studio = stage.studio.child;
  console.log(`${controllers.join(', ')} in turn, one switch a second`);
  const alone = await watch('without viewers', robot, studio);
  const { from } = JSON.parse(stage.run(['status', '--format', 'json'])).connections[0];
  const [task, port] = [from.slice(0, from.lastIndexOf('.')), from.slice(from.lastIndexOf('.') + 1)];
  const pages = [];
  for (let i = 0; i < Number(viewers); ++i) {
    const page = await stage.browser.newPage();
    await page.goto(place);
    await page.evaluate(connect, { address, key, looked: [...documents, `task/${task}`, `port/${task}/${port}`] });
    pages.push(page);
  }
  const watched = await watch(`with ${viewers} viewers`, robot, studio);
  for (const one of ['robot', 'studio']) figure('viewers cost the ' + one, watched[one] - alone[one], '% of a core', { most: wanted[one] });
  const received = await Promise.all(pages.map((page) => page.evaluate(() => window.received)));
  console.log(`each received ${received[0].messages} messages, ${(received[0].bytes / 1000).toFixed(0)} kB`);
  failed = false;
} finally {
  await stage.close(failed);
}
