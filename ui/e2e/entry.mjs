// SPDX-License-Identifier: Apache-2.0
// Who comes in, and what happens when a side of the connection ends. Status 77: there is no browser.
//   node entry.mjs SEGUE SCREENSHOT_FOLDER
import { createServer } from 'node:net';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { end, Stage } from './stage.mjs';

const stage = new Stage(...process.argv.slice(2));
const lost = (page) => page.getByText('The studio cannot be reached');
const refused = (page) => page.getByText('The studio does not know this browser');
const shown = (page) => page.getByText('4 tasks, 4 connections');

/** A port that nobody listens at. */
function freePort() {
  return new Promise((resolve) => {
    const server = createServer().listen(0, '127.0.0.1', () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });
}

const startRobot = (port) =>
  stage.start(['run', 'rover/robot.yaml', '--controller', 'explore', '--studio', '--studio-port', String(port)], /http:\/\/127\.0\.0\.1:\d+\/\?token=[0-9a-f]{64}/);

/** The studio of `segue run --studio` ends with the robot, however that ends; the next one knows no browser, until one of its pages has come in. */
async function comeBack(page) {
  const port = await freePort();
  let robot = await startRobot(port);
  await page.goto(robot.found);
  await shown(page).waitFor();
  assert.equal(new URL(page.url()).port, String(port));
  robot.child.kill('SIGKILL');
  await lost(page).waitFor();
  await stage.capture(page, 'studio_lost');
  robot = await startRobot(port);
  await refused(page).waitFor();
  const second = await stage.browser.newPage();
  await second.goto(robot.found);
  await shown(second).waitFor();
  assert.equal(new URL(second.url()).hash, '', 'the key is not in the address');
  await refused(page).waitFor({ state: 'detached' });
  await shown(page).waitFor();
  await second.close();

  const stranger = await stage.visitor();
  const other = await stranger.newPage();
  await other.goto(page.url());
  await other.getByText('no token and no valid cookie').waitFor();
  await stranger.close();
  return robot;
}

/** Over TLS a browser shows a person's certificate, whose role says what it may do. */
async function comeWithCertificates() {
  const place = (name) => join(stage.folder, 'certificates', name);
  const enrol = (name, ...more) => stage.run(['host', 'enrol', name, '--authority', place('ca'), '--out', place(name), ...more]);
  stage.run(['host', 'init', '--no-host', '--authority', place('ca'), '--out', place('own')]);
  enrol('base', '--host', '--address', '127.0.0.1');
  enrol('ann', '--role', 'operate');
  enrol('bob');
  const studio = await stage.start(['studio', '--port', '0', '--listen', '127.0.0.1', '--credentials', place('base')], /https:\/\/base:\d+\//);
  const origin = 'https://127.0.0.1:' + new URL(studio.found).port;
  const enter = async (name) => {
    const files = name && { certPath: join(place(name), name + '.crt'), keyPath: join(place(name), name + '.key') };
    const context = await stage.visitor({ ignoreHTTPSErrors: true, clientCertificates: files ? [{ origin, ...files }] : [] });
    const page = await context.newPage();
    return { context, page, answer: await page.goto(origin).catch((error) => error) };
  };
  const ann = await enter('ann');
  await shown(ann.page).waitFor();
  assert.equal(await ann.page.getByText('observe only').count(), 0);
  const bob = await enter('bob');
  await shown(bob.page).waitFor();
  await bob.page.getByText('observe only').waitFor();
  const nobody = await enter(null);
  assert.ok(nobody.answer instanceof Error, 'without a certificate');
  for (const one of [ann, bob, nobody]) await one.context.close();
  assert.equal(await end(studio.child), 0);
}

await stage.play(async () => {
  stage.run(['init', 'rover']);
  const page = await stage.openBrowser();
  const robot = await comeBack(page);
  await comeWithCertificates();
  assert.equal(await end(robot.child), 0);
  await lost(page).waitFor();
});
