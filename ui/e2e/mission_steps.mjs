// SPDX-License-Identifier: Apache-2.0
// Steps a real mission of a real robot through a real browser. Status 77: there is no browser.
//   node mission_steps.mjs SEGUE SCREENSHOT_FOLDER
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { end, Stage } from './stage.mjs';

const stage = new Stage(...process.argv.slice(2));

/** Looks for a place, does two things at once, and drives to the place, where it never arrives. */
const deliver = `mission: deliver
actions:
  look: {outputs: {place: map}, run: {simulated: {duration: 50ms, outputs: {place: {x: 1000.0, y: 0.0}}}}}
  check: {inputs: {place: map, limit: float}, outputs: {name: text}, run: {simulated: {duration: 50ms, outputs: {name: "<b>shelf</b>"}}}}
  wait: {run: {simulated: {duration: 50ms}}}
  decide: {run: {decide: [{outcome: success}]}}
  drive_to:
    inputs: {place: map}
    run:
      controller: go_to
      set: {seeker.speed: 2.0}
      call: {seeker.set_goal: {goal: "{place}"}}
      until: [{task: seeker, state: arrived}, {after: 5min}]
start: plan
flows: [plan.place -> drive.place]
states:
  plan:
    outputs: {place: map}
    start: look
    flows: [look.place -> check.place, look.place -> outputs.place]
    states:
      look: {on: {success: check}}
      check: {inputs: {limit: 2.5}, on: {success: return success}}
    on: {success: both}
  both:
    kind: barrier
    states:
      left: {action: wait}
      right:
        start: turn
        states:
          turn: {action: wait, on: {success: lift}}
          lift: {action: wait, on: {success: return success}}
      decide: {kind: decider, on: {success: return success}}
    on: {success: drive}
  drive: {action: drive_to, on: {success: return success}}
`;

/** In which all states are in view. */
const large = { width: 1920, height: 1080 };

const startMission = (...options) => stage.start(['mission', 'run', 'deliver.yaml', '--robot', 'rover', '--follow', '--no-progress', ...options], /began plan\/look/);

/** What a page shows of the mission. */
function partsOf(page) {
  const state = (path) => page.locator('.react-flow__node[data-id="state:' + path + '"]');
  return {
    state,
    seen: (locator) => locator.waitFor(),
    gone: (locator) => locator.waitFor({ state: 'detached' }),
    button: (name) => page.getByRole('group', { name: 'Steer the mission' }).getByRole('button', { name, exact: true }),
    badge: (text) => page.locator('.main > .bar .badge', { hasText: text }),
    panel: (path) => page.getByRole('complementary', { name: 'State ' + path, exact: true }),
    mark: (path, on) => state(path).locator('.box-mark[aria-pressed=' + on + ']'),
    /** It is held before just these states. */
    async heldAt(...paths) {
      for (const path of paths) await page.locator('.held').getByRole('button', { name: path, exact: true }).waitFor();
      await page.waitForFunction((count) => document.querySelectorAll('.held button').length === count, paths.length);
      for (const path of paths) await state(path).locator('.life-next').first().waitFor();
    },
  };
}

/** Where a breakpoint of the command line is; over, back, into and out. */
async function step(page) {
  const { state, seen, button, badge, panel, mark, heldAt } = partsOf(page);
  await seen(badge('paused'));
  await heldAt('plan/check');
  await seen(mark('plan/check', true));
  await seen(state('plan').locator('.life-running').first());
  await seen(state('plan/look').locator('.life-done'));
  await stage.capture(page, 'steps_held');

  await state('plan/check').click();
  const check = panel('plan/check');
  await seen(check.locator('[data-port=place]').getByText('{"x":1000.0,"y":0.0}'));
  await seen(check.locator('[data-port=limit]').getByText('2.5'));
  await seen(check.getByText('as they would be if it began now'));
  await stage.capture(page, 'steps');

  await page.keyboard.press('n');
  await heldAt('both');
  await seen(panel('both'));
  await button('Back').click();
  await heldAt('plan/check');
  await button('Over').click();
  await heldAt('both');
  await state('plan/check').click();
  await seen(panel('plan/check').getByText('what is around it does not run'));
  await button('Into').click();
  await heldAt('both/right/turn');
  await seen(state('both/left').locator('.life-done'));
  await page.keyboard.press('f');
  await heldAt('drive');
  await page.getByRole('button', { name: 'deliver', exact: true }).click();
  await seen(panel('deliver').getByText('no inputs or outputs'));
  await page.keyboard.press('Escape');
  assert.deepEqual(JSON.parse(stage.run(['mission', 'status', '--format', 'json'])).control.at, ['drive']);
}

/** The values of a state at which the pointer or the focus rests. */
async function peek(page) {
  const { state, seen, gone } = partsOf(page);
  const tip = page.getByRole('tooltip');
  await stage.laidOut(page); // without the panel that was closed
  await state('drive').hover();
  await seen(tip.getByText('{"x":1000.0,"y":0.0}'));
  await stage.capture(page, 'steps_tip');
  await page.keyboard.press('Escape');
  await gone(tip);
  await page.mouse.move(2, 2);
  await state('plan/look').focus();
  await page.keyboard.press('Tab');
  await page.keyboard.press('Shift+Tab');
  await seen(tip.getByText('plan/look'));
  assert.equal(await state('plan/look').getAttribute('aria-describedby'), await tip.getAttribute('id'));
  await page.keyboard.press('Escape');
  await gone(tip);
}

/** A breakpoint that is set here holds, one that is removed does not; goes on elsewhere. */
async function breakAndGoOn(page, other) {
  const { state, seen, gone, button, panel, mark, heldAt } = partsOf(page);
  for (const one of [page, other]) await one.getByRole('button', { name: 'open all' }).click(); // containers in which nothing runs may be closed
  await state('plan/check').click();
  await panel('plan/check').getByRole('checkbox', { name: 'breakpoint' }).uncheck();
  await seen(mark('plan/check', false));
  await stage.laidOut(page);
  await state('both/right/lift').hover();
  await mark('both/right/lift', false).click();
  await seen(mark('both/right/lift', true));
  await seen(partsOf(other).mark('both/right/lift', true));

  await state('plan/look').click();
  await panel('plan/look').getByRole('button', { name: 'Go on here' }).click();
  await heldAt('plan/look');
  await button('Resume').click();
  await heldAt('both/right/lift');
  assert.deepEqual(JSON.parse(stage.run(['mission', 'status', '--format', 'json'])).control.breakpoints, ['both/right/lift']);
  await partsOf(other).heldAt('both/right/lift');
  await stage.capture(page, 'steps_concurrent');

  // What is preempted is named first.
  await state('drive').click();
  await panel('drive').getByRole('button', { name: 'Go on here …' }).click();
  const question = panel('drive').getByRole('group', { name: 'Go on at drive' });
  await seen(question.getByText('both is under way and will be preempted.'));
  await stage.capture(page, 'steps_question');
  await question.getByRole('button', { name: 'Preempt and go on here' }).click();
  await heldAt('drive');

  // There is no way back; all pages see why.
  await button('Back').click();
  for (const one of [page, other]) await seen(one.locator('.refusal').getByRole('alert'));
  await stage.capture(page, 'steps_refused');
  await page.getByRole('button', { name: 'dismiss' }).click();
  await gone(page.locator('.refusal'));

  // A breakpoint by keyboard, at the state that has the focus.
  await state('drive').focus();
  await page.keyboard.press('Tab');
  await page.keyboard.press('Shift+Tab');
  await page.keyboard.press('b');
  await seen(mark('drive', true));
  await page.keyboard.press('b');
  await seen(mark('drive', false));
}

/** Who observes sees where it is held and what others have asked for, and can ask for nothing. */
async function observe(observer) {
  const { state, seen, gone, mark, panel, heldAt } = partsOf(observer);
  await observer.getByRole('link', { name: 'Missions' }).click();
  await heldAt('drive');
  await seen(mark('both/right/lift', true));
  assert.ok(await mark('both/right/lift', true).isDisabled());
  await gone(observer.getByRole('group', { name: 'Steer the mission' }));
  await state('drive').click();
  await seen(panel('drive').locator('[data-port=place]').getByText('{"x":1000.0,"y":0.0}'));
  assert.ok(await panel('drive').getByRole('checkbox', { name: 'breakpoint' }).isDisabled());
  assert.equal(await panel('drive').getByRole('button', { name: 'Go on here' }).count(), 0);
}

async function runOn(page, other) {
  const { state, seen, gone, button, badge } = partsOf(page);
  await button('Resume').click();
  await seen(state('drive').locator('.life-running'));
  await seen(badge('running'));
  assert.ok(await button('Into').isDisabled());
  await button('Into').hover();
  await seen(page.locator('.why-not:visible', { hasText: 'the mission must be paused first' }));
  await page.emulateMedia({ colorScheme: 'dark' });
  await stage.capture(page, 'steps_dark');
  await page.emulateMedia({ colorScheme: 'light' });
  await page.getByRole('button', { name: 'Stop', exact: true }).click();
  for (const one of [page, other]) await seen(partsOf(one).badge('ended: preempted'));
  await gone(page.getByRole('group', { name: 'Steer the mission' }));
  await gone(state('both/right/lift').locator('.box-mark'));
}

/** What runs concurrently cannot be stepped, and says so. */
async function runConcurrently(page) {
  const { state, seen, button, badge } = partsOf(page);
  const { child } = await startMission('--mode', 'concurrent');
  await seen(page.getByText('A concurrent run can only be paused.'));
  await seen(button('Pause'));
  assert.equal(await button('Into').count(), 0);
  assert.equal(await state('drive').locator('.box-mark').count(), 0);
  await stage.capture(page, 'steps_not');
  await end(child);
  await seen(badge('ended'));
}

await stage.play(async () => {
  stage.run(['init', 'rover']);
  writeFileSync(join(stage.folder, 'deliver.yaml'), deliver);
  await stage.start(['run', 'rover/robot.yaml', '--controller', 'explore'], /robot rover runs/);
  await stage.settled('explore');
  const page = await stage.enter();
  await page.setViewportSize(large);
  await page.getByRole('link', { name: 'Missions' }).click();
  const other = await stage.browser.newPage();
  await other.setViewportSize(large);
  await other.goto(page.url());
  const { child } = await startMission('--break', 'plan/check', '--steps-back');
  const ended = new Promise((resolve) => child.on('exit', resolve));
  await step(page);
  await peek(page);
  await breakAndGoOn(page, other);
  const observing = await stage.startStudio('--observe');
  const observer = await stage.browser.newPage();
  await observer.goto(observing.found);
  await observe(observer);
  await observer.close();
  await runOn(page, other);
  await ended;
  await runConcurrently(page);
});
