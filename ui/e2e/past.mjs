// SPDX-License-Identifier: Apache-2.0
// The past of a real robot in a real browser: films of transitions, and what ran at a time. Status 77: there is no browser.
//   node past.mjs SEGUE SCREENSHOT_FOLDER
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { addPanel, coloured } from './panels.mjs';
import { lookAt } from './screens.mjs';
import { Stage } from './stage.mjs';

const [segue, pictures] = process.argv.slice(2);
const stage = new Stage(segue, pictures);

/** A robot that has switched, failed and undone it. */
async function makeAPast() {
  stage.run(['init', 'rover']);
  const controllers = join(stage.folder, 'rover/controllers');
  const go = readFileSync(join(controllers, 'go_to.yaml'), 'utf8');
  const broken = go.replace('network: go_to', 'network: broken').replace('"demo::LaserScanner"', '"demo::LaserScanner", properties: {beams: 1}');
  writeFileSync(join(controllers, 'broken.yaml'), broken);
  await stage.start(['run', 'rover/robot.yaml', '--controller', 'explore'], /robot rover runs/);
  await stage.settled('explore');
  stage.run(['switch', 'go_to']);
  assert.throws(() => stage.run(['switch', 'broken']));
  stage.run(['switch', 'manual']);
}

const line = (page, name) => page.getByRole('region', { name: 'Past requests' }).getByRole('button', { name });
const taskIn = (page, name) => page.locator('.task-box', { has: page.getByText(name, { exact: true }) });

/** Sets a slider by keyboard. */
async function press(slider, ...keys) {
  await slider.focus();
  for (const key of keys) await slider.press(key);
}

async function watchFilms(page) {
  await line(page, 'explore → go_to').click();
  const film = page.getByRole('region', { name: 'Film', exact: true });
  const slider = film.getByRole('slider', { name: 'Time of the film' });
  await slider.waitFor();
  // At its begin nothing has come true.
  await page.locator('[data-moment=waiting]', { hasText: 'start seeker' }).waitFor();
  await taskIn(page, 'seeker').filter({ hasText: 'not yet' }).waitFor();
  await taskIn(page, 'wanderer').filter({ hasText: 'running' }).waitFor();
  await press(slider, 'End');
  await page.locator('[data-moment=done]', { hasText: 'start seeker' }).waitFor();
  await taskIn(page, 'seeker').filter({ hasText: 'running' }).waitFor();
  await taskIn(page, 'wanderer').filter({ hasText: 'gone' }).waitFor();
  await stage.capture(page, 'past_film');
  await press(slider, 'Home', 'ArrowRight');
  await taskIn(page, 'wanderer').filter({ hasText: 'running' }).waitFor();
  // Playing from here ends at the end by itself.
  await film.getByLabel('Speed').selectOption('0.25');
  await film.getByRole('button', { name: 'Play' }).click();
  await taskIn(page, 'wanderer').filter({ hasText: 'gone' }).waitFor();
  await film.getByRole('button', { name: 'Play' }).waitFor();

  // One that was undone.
  await line(page, 'go_to → broken').click();
  await page.getByRole('complementary', { name: 'Past transition' }).getByText('failed, restored').waitFor();
  await press(slider, 'End');
  await page.locator('[data-moment=failed]').first().waitFor();
  await page.getByRole('region', { name: 'Undo' }).locator('[data-moment=done]').first().waitFor();
  await taskIn(page, 'seeker').filter({ hasText: 'running' }).waitFor();
  await stage.capture(page, 'past_undone');
  await film.getByRole('button', { name: 'Close the film' }).click();
}

const left = async (mark) => Math.round((await mark.boundingBox()).x);

/** The cursor of a chart moves with the film, and the film with clicks into the chart. */
async function moveThroughChart(page, chart, slider) {
  const [cursor, area] = [chart.locator('.film-cursor'), await chart.locator('.u-over').boundingBox()];
  let [first, last] = [0, 0];
  for (let zoomed = 0; zoomed < 20; ++zoomed) {
    await press(slider, 'End');
    last = await left(cursor);
    await press(slider, 'Home');
    first = await left(cursor);
    if (last - first > area.width / 5) break;
    await slider.fill('100');
    await page.getByRole('region', { name: 'Plots of this time' }).getByRole('button', { name: 'Zoom in' }).click();
  }
  assert.ok(area.x < first && first + 30 < last && last < area.x + area.width, [area.x, first, last, area.width].join(' '));
  const commit = await chart.locator('.phase-commit').boundingBox();
  assert.ok(first - 1 <= commit.x && commit.x + commit.width <= last + 3, 'the commit lies within the film');

  const track = await slider.boundingBox();
  await page.mouse.move(track.x + 8, track.y + track.height / 2);
  await page.mouse.down();
  await page.mouse.move(track.x + track.width / 2, track.y + track.height / 2, { steps: 5 });
  await page.mouse.up();
  assert.ok(Math.abs((await left(cursor)) - (first + last) / 2) <= 0.1 * (last - first) + 2, 'the cursor follows the slider');
  await page.mouse.click(last - (last - first) / 4, area.y + area.height / 2);
  assert.ok(Math.abs((await left(cursor)) - (last - (last - first) / 4)) <= 3, 'the cursor comes to the click');
  assert.ok(Math.abs(Number(await slider.inputValue()) - 150) <= 0.1 * 200, 'the film comes to the click');
  await page.mouse.click(area.x + 2, area.y + area.height / 2); // before the film
  assert.equal(await slider.inputValue(), '0');
  await chart.getByRole('img').press('ArrowRight');
  assert.equal(await slider.inputValue(), '1');
  await page.getByRole('button', { name: 'Play' }).click();
  await page.getByRole('button', { name: 'Play' }).waitFor();
  assert.equal(await left(cursor), last);
}

/** The film of a switch beside the plots of its time. */
async function watchSignals(page) {
  await line(page, 'go_to → broken').click();
  await page.getByText('No plots of this time: samples are kept from when a port is plotted over time, while this page is open.').waitFor();
  await page.getByRole('link', { name: 'Plot a port' }).click();
  await addPanel(page, { fields: { 'drive.velocity': ['forward', 'turn'] }, title: 'Speed' });
  await addPanel(page, { fields: { 'odometry.pose': ['x', 'y'] }, title: 'Position', kind: 'plot over time' });
  await page.getByRole('region', { name: 'Position', exact: true }).locator('[data-line="1"]', { hasText: /\d/ }).waitFor();
  await page.getByRole('link', { name: 'Switch' }).click();
  stage.run(['switch', 'go_to']);
  await page.getByRole('link', { name: 'Past' }).click();
  await line(page, 'manual → go_to').click();
  const plots = page.getByRole('region', { name: 'Plots of this time' });
  const speed = plots.getByRole('region', { name: 'Speed' });
  await coloured(speed.locator('canvas'), [31, 95, 208]);
  const slider = page.getByRole('slider', { name: 'Time of the film' });
  await press(slider, 'End');
  await speed.getByText(/drive.velocity forward -?\d/).waitFor();
  await plots.getByRole('region', { name: 'Position' }).getByText(/odometry.pose x -?\d/).waitFor();
  await taskIn(page, 'seeker').filter({ hasText: 'running' }).waitFor();
  assert.deepEqual(await lookAt(stage, page, 'past_signals'), []);
  await page.setViewportSize({ width: 1360, height: 820 });
  await moveThroughChart(page, speed, slider);
  await stage.capture(page, 'past_signals');
  await plots.getByRole('button', { name: 'All' }).click();
  await page.getByRole('button', { name: 'Close the film' }).click();
}

async function goBackInTime(page) {
  const at = page.getByRole('complementary', { name: 'At that time' });
  const controllerThen = (name) => at.locator('[data-controller="' + name + '"]').waitFor();
  const slider = page.getByRole('region', { name: 'The robot at a time' }).getByRole('slider', { name: 'Time' });
  await slider.waitFor();
  await press(slider, 'End');
  await controllerThen('manual');
  await taskIn(page, 'joystick').waitFor();
  await page.getByRole('button', { name: 'earlier' }).click();
  await controllerThen('explore');
  await taskIn(page, 'wanderer').waitFor();
  await stage.capture(page, 'past_moment');
  await press(slider, 'Home');
  await controllerThen('');
  await taskIn(page, 'wanderer').waitFor({ state: 'detached' });
}

async function search(page) {
  await page.keyboard.press('7');
  const requests = page.getByRole('region', { name: 'Past requests' });
  await requests.locator('[data-request]').nth(3).waitFor();
  assert.match(await requests.locator('[data-request]').first().innerText(), /go_to → manual/);
  const box = requests.getByRole('searchbox');
  await box.fill('BROKEN failed');
  await line(page, 'explore → go_to').waitFor({ state: 'detached' });
  await line(page, 'go_to → broken').waitFor();
  await box.fill('<img src=x>');
  await requests.getByText('No request has these words.').waitFor();
  await box.fill('');
  await line(page, 'explore → go_to').waitFor();
  // What happens now comes in front.
  stage.run(['switch', 'explore']);
  await line(page, 'manual → explore').waitFor();
  stage.run(['switch', 'manual']);
  await line(page, 'explore → manual').waitFor();
}

await stage.play(async () => {
  await makeAPast();
  const page = await stage.enter();
  await page.getByRole('link', { name: 'Past' }).waitFor();
  await search(page);
  await watchFilms(page);
  await goBackInTime(page);
  await watchSignals(page);
  await page.emulateMedia({ colorScheme: 'dark' });
  await line(page, 'manual → go_to').click();
  await page.getByRole('region', { name: 'Plots of this time' }).waitFor();
  await stage.capture(page, 'past_dark');
});
