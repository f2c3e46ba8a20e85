// SPDX-License-Identifier: Apache-2.0
// The view Edit, of a robot made by `segue init rover`.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';

async function holds(what, message) {
  const end = Date.now() + 30000;
  while (!(await what())) {
    assert.ok(Date.now() < end, message);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

/** `capture(page, name)` takes a picture and asks axe-core; `folder` has the robot's files in `rover`. */
export async function driveEdit(page, { folder, capture, run }) {
  const seen = (locator) => locator.waitFor();
  const place = join(folder, 'rover/controllers/explore.yaml');
  const onDisk = () => readFileSync(place, 'utf8');
  const before = onDisk();
  const text = page.locator('.cm-content');
  const shown = async () => (await text.locator('.cm-line').allTextContents()).join('\n');
  const problems = page.getByRole('region', { name: 'Problems' });
  const status = (words) => page.getByRole('status').filter({ hasText: words });
  const node = (id) => page.locator(`.edit-graph .react-flow__node[data-id=${id}]`);
  const handle = (id, port) => node(id).locator(`[data-handleid=${port}]`);
  const draw = async (from, to) => {
    const [begin, end] = [await from.boundingBox(), await to.boundingBox()];
    await page.mouse.move(begin.x + begin.width / 2, begin.y + begin.height / 2);
    await page.mouse.down();
    await page.mouse.move(end.x - 20, end.y - 20, { steps: 4 });
    await page.mouse.move(end.x + end.width / 2, end.y + end.height / 2, { steps: 4 });
    await page.mouse.up();
  };

  // No task disappears while somebody types, not even for a moment.
  await page.evaluate(() => {
    window.hiddenTasks = [];
    const look = (records) => records.forEach(({ target }) => target.style.visibility === 'hidden' && window.hiddenTasks.push(target.dataset.id ?? target.className));
    new MutationObserver(look).observe(document.body, { subtree: true, attributes: true, attributeFilter: ['style'] });
  });

  // A problem is shown at its place while somebody types, and the text outlives the view.
  await page.getByRole('link', { name: 'Edit' }).click();
  await page.getByRole('button', { name: 'controllers/explore.yaml' }).click();
  await seen(problems.getByText('No problems'));
  await seen(node('laser'));
  await text.click();
  await page.keyboard.press('Control+End');
  await page.keyboard.type('  - odometry.pose -> drive.command # 1');
  await seen(problems.getByText('error:'));
  await seen(page.locator('.cm-lint-marker-error'));
  await capture(page, 'edit_problem');
  await page.getByRole('link', { name: 'Network' }).click();
  await page.getByRole('link', { name: 'Edit' }).click();
  await seen(status('unsaved changes'));
  await text.click();
  await holds(async () => {
    await page.keyboard.press('Control+z');
    return status('as in the file').isVisible();
  }, 'all is undone');
  await seen(problems.getByText('No problems'));

  // The graph changes the text where it must.
  await node('laser').click();
  const panel = page.getByRole('complementary', { name: 'Edit task laser' });
  await panel.getByLabel('beams', { exact: true }).fill('16');
  await panel.getByLabel('beams', { exact: true }).press('Enter');
  await holds(async () => (await shown()).includes('laser: {component: "demo::LaserScanner", properties: {beams: 16}}'), 'a property is set');
  await page.getByText('Add a task').click();
  await capture(page, 'edit_task');
  await page.getByLabel('Find components').fill('joystick');
  await page.getByRole('button', { name: 'demo::Joystick' }).press('Enter');
  await page.getByText('Add a task').click();
  await seen(handle('joystick', 'command'));
  await page.getByRole('complementary', { name: 'Edit task joystick' }).getByRole('button', { name: 'Close' }).click();
  await holds(async () => {
    await draw(handle('joystick', 'command'), handle('drive', 'command')); // again where the graph moved meanwhile
    return (await shown()).includes('- joystick.command -> drive.command');
  }, 'two ports are connected');
  await draw(handle('laser', 'scan'), handle('drive', 'command'));
  assert.ok(!(await shown()).includes('laser.scan -> drive.command'), 'ports of different types are not');
  await seen(status('unsaved changes'));
  await page.getByRole('button', { name: 'Fit View' }).click();
  await capture(page, 'edit');
  await node('joystick').focus();
  await page.keyboard.press('Enter');
  await page.getByRole('complementary', { name: 'Edit task joystick' }).getByLabel('Name', { exact: true }).fill('stick');
  await page.keyboard.press('Enter');
  await seen(handle('stick', 'command'));
  await holds(async () => (await shown()).includes('- stick.command -> drive.command'), 'a task is renamed with its connections');
  await page.getByRole('complementary', { name: 'Edit task stick' }).getByLabel('Name', { exact: true }).fill('drive');
  await page.keyboard.press('Enter');
  await seen(page.getByRole('complementary', { name: 'Edit task stick' }).getByText('there is a task drive already'));
  await page.keyboard.press('Escape');
  await page.getByRole('complementary', { name: 'Edit task stick' }).getByRole('button', { name: 'Remove stick.command to drive.command' }).press('Enter');
  await page.getByLabel('Connect stick.command').selectOption('drive.command');
  await page.getByRole('button', { name: 'Remove task' }).press('Enter');
  await node('stick').waitFor({ state: 'detached' });

  assert.deepEqual(await page.evaluate(() => window.hiddenTasks), [], 'tasks that disappeared');

  // Saved, and taken by the robot.
  await seen(problems.getByText('No problems'));
  await text.click();
  await page.keyboard.press('Control+s');
  await seen(status('as in the file'));
  assert.equal(onDisk(), before.replace('"demo::LaserScanner"}', '"demo::LaserScanner", properties: {beams: 16}}'));
  await page.getByRole('button', { name: 'Apply', exact: true }).click();
  await seen(page.getByText('applied: explore'));
  assert.deepEqual(JSON.parse(run(['status', '--format', 'json'])).changed_files, []);

  // What somebody else has written is not written over.
  await text.click();
  await page.keyboard.press('Control+Home');
  await page.keyboard.type('# mine');
  await page.keyboard.press('Enter');
  const theirs = '# theirs\n' + onDisk();
  writeFileSync(place, theirs);
  await page.getByRole('button', { name: 'Save', exact: true }).click();
  await seen(page.getByRole('alert').filter({ hasText: 'changed by somebody else' }));
  assert.equal(onDisk(), theirs);
  await capture(page, 'edit_conflict');
  await page.getByRole('button', { name: 'keep mine' }).click();
  assert.match(await page.getByLabel('Your text of before').inputValue(), /^# mine\n/);
  await holds(async () => (await shown()).startsWith('# theirs\n'), 'the file is read again');
  await page.emulateMedia({ colorScheme: 'dark' });
  await capture(page, 'edit_dark');
  await page.emulateMedia({ colorScheme: 'light' });

  // Nobody leaves the page with unsaved changes without being asked.
  await text.click();
  await page.keyboard.type('#');
  await seen(status('unsaved changes'));
  let asked = '';
  page.once('dialog', (dialog) => {
    asked = dialog.type();
    void dialog.accept();
  });
  await page.reload();
  assert.equal(asked, 'beforeunload');
  assert.equal(onDisk(), theirs);
}

/** Who may only observe reads the files. */
export async function observeEdit(page) {
  await page.getByRole('link', { name: 'Edit' }).click();
  await page.getByRole('button', { name: 'controllers/go_to.yaml' }).click();
  await page.getByText('read only').waitFor();
  await page.getByRole('region', { name: 'Problems' }).getByText('No problems').waitFor();
  await page.locator('.cm-content').focus();
  await page.keyboard.type('x');
  await page.getByRole('status').filter({ hasText: 'as in the file' }).waitFor();
  for (const name of ['Save', 'Apply']) assert.equal(await page.getByRole('button', { name, exact: true }).count(), 0);
}
