// SPDX-License-Identifier: Apache-2.0
// The view Edit with missions, a machine of RAFCON and new files, of a real robot in a real browser. Status 77: there is no browser.
//   node edit_missions.mjs SEGUE SCREENSHOT_FOLDER
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { Stage } from './stage.mjs';

const [segue, pictures] = process.argv.slice(2);
const stage = new Stage(segue, pictures);
const file = (path) => join(stage.folder, 'rover', path);
const onDisk = (path) => readFileSync(file(path), 'utf8');

const mission = `# Fetches the box.
mission: fetch
actions:
  look:   # sees
    outputs: {pose: map, near: bool}
    outcomes: [found, nothing]
    description: looks <b>around</b>
    run: {simulated: {duration: 1s}}
  grasp: {inputs: {pose: map, force: float}, run: {simulated: {duration: 1s}}}
outcomes: [done, failed]
start: look
flows:
  - look.pose -> grasp.pose   # where it is
states:
  # first of all
  look: {on: {found: grasp, nothing: return failed}}
  grasp:
    inputs: {force: 2.0}
    on: {success: return done}   # it has it
`;
const library = `mission: store
description: puts it away
inputs: {pose: map}
actions: {put: {run: {simulated: {duration: 1s}}}}
start: put
states: {put: {on: {success: return success}}}
`;

function outcome(id, name) {
  return { __jsonqualname__: 'rafcon.core.state_elements.logical_port.Outcome', outcome_id: id, name };
}
function writeMachine() {
  const leaf = (name, id) => ({
    __jsonqualname__: 'rafcon.core.states.execution_state.ExecutionState', state_id: id, name, description: null, input_data_ports: {}, output_data_ports: {},
    outcomes: { 0: outcome(0, 'success'), '-1': outcome(-1, 'aborted'), '-2': outcome(-2, 'preempted') },
  });
  const transition = (id, from, fromOutcome, to, toOutcome) => ({
    __jsonqualname__: 'rafcon.core.state_elements.transition.Transition', transition_id: id, from_state: from, from_outcome: fromOutcome, to_state: to, to_outcome: toOutcome,
  });
  const root = {
    ...leaf('greet', 'ROOTAA'), __jsonqualname__: 'rafcon.core.states.hierarchy_state.HierarchyState', start_state_id: 'SAYAAA', scoped_variables: {}, data_flows: {},
    transitions: { 0: transition(0, 'ROOTAA', null, 'SAYAAA', null), 1: transition(1, 'SAYAAA', 0, 'ROOTAA', 0) },
  };
  mkdirSync(file('machines/greet/say_SAYAAA'), { recursive: true });
  writeFileSync(file('machines/greet/statemachine.json'), JSON.stringify({ used_rafcon_version: '2.4.0' }));
  writeFileSync(file('machines/greet/core_data.json'), JSON.stringify(root));
  writeFileSync(file('machines/greet/say_SAYAAA/core_data.json'), JSON.stringify(leaf('say', 'SAYAAA')));
  writeFileSync(file(semanticFile), semanticData);
  writeFileSync(file('machines/greet/say_SAYAAA/script.py'), 'def execute(self, inputs, outputs, gvm):\n    return 0\n');
}

/** As RAFCON writes them with Python 2. */
const semanticData = JSON.stringify({ RAFCONTPP: { PDDL_ACTION: { description: {}, pddl_action: '(:action say\n    :precondition (awake ?me)\n)', pddl_types: 'Person' } } }, null, 4).replace(/,\n/g, ', \n');
const semanticFile = 'machines/greet/say_SAYAAA/semantic_data.json';

async function holds(what, message) {
  const end = Date.now() + 30000;
  while (!(await what())) {
    assert.ok(Date.now() < end, message);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

/** Takes back one step after the other; the page may take its time to show each, and none too many is taken back. */
async function undoUntil(page, text, done) {
  const shown = () => text.locator('.cm-line').allTextContents();
  for (let lines = await shown(); !done(lines); lines = await shown()) {
    await page.getByRole('button', { name: 'Undo', exact: true }).press('Enter');
    await holds(async () => (await shown()).join('\n') !== lines.join('\n'), 'a step is taken back');
  }
}

/** A picture and axe-core; axe-core itself fails where the page changes under it, and looks again then. */
async function capture(page, name) {
  for (let left = 5; ; --left) {
    try {
      return await stage.capture(page, name);
    } catch (error) {
      if (left === 0 || error instanceof assert.AssertionError) throw error;
    }
  }
}

function helpers(page) {
  const text = page.locator('.cm-content');
  return {
    text,
    seen: (locator) => locator.waitFor(),
    has: (part, message) => holds(async () => (await text.locator('.cm-line').allTextContents()).join('\n').includes(part), message),
    problems: page.getByRole('region', { name: 'Problems' }),
    status: (words) => page.getByRole('status').filter({ hasText: words }),
    state: (id) => page.locator(`.edit-graph .react-flow__node[data-id="state:${id}"]`),
    panel: (id) => page.getByRole('complementary', { name: 'Edit state ' + id, exact: true }),
    open: (path) => page.getByRole('region', { name: 'Files' }).getByRole('button', { name: path, exact: true }).press('Enter'),
  };
}

/** What the mission declares of an action, in the panel of a state that stands for it. */
async function editAction(page) {
  const { text, has, panel } = helpers(page);
  await panel('grasp').getByRole('button', { name: 'Action grasp' }).press('Enter');
  const action = panel('grasp').getByRole('region', { name: 'Action grasp' });
  const set = async (label, value, part) => {
    await action.getByLabel(label, { exact: true }).fill(value);
    await page.keyboard.press('Enter');
    await has(part, label + ' is set');
  };
  await set('simulated duration', '2s', 'run: {simulated: {duration: 2s}}');
  await set('expected duration', '3s', 'expect: {duration: 3s}');
  await set('default of force', '1.5', 'inputs: {pose: map, force: {type: float, default: 1.5}}');
  await set('New entry of preconditions', '!held({pose})', 'preconditions: ["!held({pose})"]');
  await set('New entry of resources', '{block: arm}', 'resources: [{block: arm}]');
  await set('New outcome of the action', 'slipped', 'outcomes: [success, slipped]');
  await action.getByLabel('pure').click(); // it shows once the text has changed
  await has('pure: true', 'it is pure');
  await panel('grasp').getByLabel('on slipped').waitFor();
  await action.getByLabel('default of force').fill('{');
  await page.keyboard.press('Enter');
  await action.locator('output.bad').waitFor();
  await capture(page, 'edit_mission_action');
  await undoUntil(page, text, (lines) => lines.includes('  grasp: {inputs: {pose: map, force: float}, run: {simulated: {duration: 1s}}}'));
}

/** By the graph's panel, and by drawing. */
async function editMission(page) {
  const { text, seen, has, problems, status, state, panel, open } = helpers(page);
  await open('missions/fetch.yaml');
  await seen(problems.getByText('No problems'));
  await seen(state('look'));
  await seen(page.getByRole('region', { name: 'Graph of the mission' }).getByText('▶ start'));

  // What is wrong stands at its place while somebody types.
  await text.click();
  await page.keyboard.press('Control+End');
  await page.keyboard.type('  odd: {}');
  await seen(problems.getByText('unknown action').or(problems.getByText("'odd'")).first());
  await seen(page.locator('.cm-lint-marker-error').first());
  await holds(async () => {
    await page.keyboard.press('Control+z');
    return status('as in the file').isVisible();
  }, 'all is undone');

  await seen(problems.getByText('No problems'));

  // A library, an action and a container come from the palette.
  await page.getByText('Add a state').press('Enter');
  await seen(page.getByText('puts it away'));
  await seen(page.getByText('looks <b>around</b>').first());
  await capture(page, 'edit_mission_palette');
  await page.getByRole('button', { name: 'library tools/store' }).press('Enter');
  await has('  store: {library: tools/store}', 'a library is added');
  await seen(panel('store'));
  await panel('store').getByLabel('Name', { exact: true }).fill('keep');
  await page.keyboard.press('Enter');
  await has('  keep: {library: tools/store}', 'it is renamed');
  await panel('keep').getByLabel('on success').selectOption('return done');
  await has('  keep: {library: tools/store, on: {success: return done}}', 'a transition is set');
  await panel('keep').getByLabel('Connect keep.pose').selectOption('look.pose');
  await has('  - look.pose -> keep.pose', 'a value flows');
  assert.equal(await panel('keep').getByLabel('Connect keep.pose').locator('option', { hasText: 'look.near' }).count(), 0, 'only compatible types are offered');

  await state('grasp').focus();
  await page.keyboard.press('Enter');
  await panel('grasp').getByLabel('force', { exact: true }).fill('3.5');
  await page.keyboard.press('Enter');
  await has('    inputs: {force: 3.5}', 'a value is set');

  await editAction(page);

  // A transition is drawn: again where the graph moved meanwhile.
  await panel('grasp').getByRole('button', { name: 'Close' }).press('Enter');
  const draw = async (from, to) => {
    const [begin, end] = [await from.boundingBox(), await to.boundingBox()];
    if (!begin || !end) return;
    await page.mouse.move(begin.x + begin.width / 2, begin.y + begin.height / 2);
    await page.mouse.down();
    await page.mouse.move(end.x - 20, end.y - 20, { steps: 4 });
    await page.mouse.move(end.x + end.width / 2, end.y + end.height / 2, { steps: 4 });
    await page.mouse.up();
  };
  await holds(async () => {
    await draw(state('grasp').locator('[data-handleid=success]'), state('keep').locator('[data-handleid=in]'));
    return (await text.locator('.cm-line').allTextContents()).join('\n').includes('    on: {success: keep}   # it has it');
  }, 'a transition is drawn');

  // Undo and redo go over what the graph did.
  await page.getByRole('button', { name: 'Undo', exact: true }).press('Enter');
  await has('    on: {success: return done}   # it has it', 'undone');
  await page.getByRole('button', { name: 'Redo', exact: true }).press('Enter');
  await page.getByRole('button', { name: 'Redo', exact: true, disabled: true, description: 'nothing to redo' }).waitFor();
  await has('    on: {success: keep}   # it has it', 'done again');
  await seen(problems.getByText('No problems'));
  await capture(page, 'edit_mission');

  // Into a container.
  await page.getByRole('button', { name: 'mission …' }).press('Enter');
  await page.getByRole('button', { name: 'container: hierarchy' }).press('Enter');
  await has('  hierarchy:', 'a container is added');
  await state('keep').focus();
  await page.keyboard.press('Enter');
  await panel('keep').getByLabel('Move into').selectOption({ label: 'hierarchy' });
  await seen(panel('hierarchy/keep'));
  await has('    states:', 'it has states');
  await page.getByText('Add a state').press('Enter');
  await page.getByLabel('data flows').check();
  await seen(state('look').locator('[data-handleid=pose]'));
  await seen(problems.getByText("state 'keep': its outcome 'success' has no transition"));
  await capture(page, 'edit_mission_flows');
  await page.getByLabel('data flows').uncheck();
  await undoUntil(page, text, (lines) => !lines.some((line) => line.startsWith('  hierarchy:')));
  await has('  keep: {library: tools/store, on: {success: return done}}', 'it is back');
  await holds(async () => (await state('hierarchy').count()) === 0, 'the container is gone');

  await text.click();
  await page.keyboard.press('Control+s');
  await seen(status('as in the file'));
  const saved = onDisk('missions/fetch.yaml');
  const wanted = mission
    .replace('force: 2.0', 'force: 3.5').replace('{success: return done}', '{success: keep}')
    .replace('# where it is\n', '# where it is\n  - look.pose -> keep.pose\n') + '  keep: {library: tools/store, on: {success: return done}}\n';
  assert.equal(saved, wanted, 'nothing else has changed');

  // Somebody else's text is not written over.
  await text.click();
  await page.keyboard.press('Control+Home');
  await page.keyboard.type('# mine');
  await page.keyboard.press('Enter');
  writeFileSync(file('missions/fetch.yaml'), '# theirs\n' + saved);
  await page.getByRole('button', { name: 'Save', exact: true }).press('Enter');
  await seen(page.getByRole('alert').filter({ hasText: 'changed by somebody else' }));
  await page.getByRole('button', { name: 'Read again', exact: true }).press('Enter');
  await has('# theirs', 'the file is read again');
  await seen(problems.getByText('No problems'));
  await page.emulateMedia({ colorScheme: 'dark' });
  await capture(page, 'edit_mission_dark');
  await page.emulateMedia({ colorScheme: 'light' });
}

/** Facts and resources of containers and of the mission are checked before they come into the text. */
async function editNeeds(page) {
  const { text, seen, has, state, panel } = helpers(page);
  await page.getByRole('button', { name: 'mission …' }).press('Enter');
  const mission = page.getByRole('complementary', { name: 'Edit mission' });
  await mission.getByLabel('New entry of world').fill('at(robot, dock)');
  await page.keyboard.press('Enter');
  await has('world:\n  - "at(robot, dock)"', 'a fact holds at first');
  await page.getByText('Add a state').press('Enter');
  await page.getByRole('button', { name: 'container: hierarchy' }).press('Enter');
  await has('  hierarchy:', 'a container is added');
  const container = panel('hierarchy');
  await container.getByLabel('New entry of resources').focus();
  await page.keyboard.press('Enter'); // adds nothing: it says what it needs
  await seen(container.getByRole('button', { name: 'add', disabled: true, description: 'needs an entry' }).first());
  assert.equal(await container.locator('output.bad').count(), 0);
  await container.getByLabel('New entry of resources').fill('{block: arm, count: 2}');
  await page.keyboard.press('Enter');
  await seen(container.locator('output.bad', { hasText: 'arm' }));
  assert.ok(!(await text.locator('.cm-line').allTextContents()).join('\n').includes('count: 2'), 'what would be wrong is not written');
  await container.getByLabel('New entry of resources').fill('{block: arm}');
  await page.keyboard.press('Enter');
  await has('    resources: [{block: arm}]', 'it holds an arm');
  await container.getByLabel('New entry of preconditions').fill('at(robot dock');
  await page.keyboard.press('Enter');
  await seen(container.locator('output.bad', { hasText: 'at(robot dock' }));
  await capture(page, 'edit_mission_needs');
  await undoUntil(page, text, (lines) => !lines.some((line) => line.startsWith('world:') || line.startsWith('  hierarchy:')));
  await holds(async () => (await state('hierarchy').count()) === 0, 'the container is gone');
  await page.getByText('Add a state').press('Enter');
}

/** The semantic data of a state of RAFCON are written to its own file. */
async function editSemanticData(page) {
  const { seen, has, state, panel, open } = helpers(page);
  await open('machines/greet');
  await seen(state('say'));
  await state('say').focus();
  await page.keyboard.press('Enter');
  const data = panel('say').getByRole('region', { name: 'Semantic data' });
  const types = data.getByLabel('RAFCONTPP › PDDL_ACTION › pddl_types', { exact: true });
  await seen(types);
  assert.equal(await data.getByLabel('RAFCONTPP › PDDL_ACTION › pddl_action', { exact: true }).inputValue(), '(:action say\n    :precondition (awake ?me)\n)');
  await types.fill('Person, Food');
  await page.keyboard.press('Enter');
  await seen(data.getByText('1 unsaved'));
  assert.equal(onDisk(semanticFile), semanticData, 'nothing is written before it is saved');

  // What would be wrong stands where it was typed, and is not taken.
  const entry = data.getByRole('form', { name: 'New entry' });
  await entry.getByLabel('in', { exact: true }).selectOption({ label: 'segue' });
  await seen(entry.getByRole('button', { name: 'Add a group', disabled: true, description: 'needs a key' }));
  await entry.getByLabel('key').fill('effect');
  await entry.getByLabel('text').fill('["+greeted()"]');
  await entry.getByRole('button', { name: 'Add the text' }).press('Enter');
  await seen(entry.getByRole('alert').filter({ hasText: "'effects'" }));
  await entry.getByLabel('key').fill('effects');
  await entry.getByRole('button', { name: 'Add the text' }).press('Enter');
  const effects = data.getByLabel('segue › effects', { exact: true });
  await seen(effects);
  await effects.fill('["+greeted("]');
  await page.keyboard.press('Enter');
  await seen(data.locator('output.bad', { hasText: '+greeted(' }));
  await capture(page, 'edit_semantic_data');
  await page.keyboard.press('Escape');
  await data.getByRole('button', { name: 'Remove RAFCONTPP', exact: true }).press('Enter');
  await types.waitFor({ state: 'detached' });
  await data.getByRole('button', { name: 'Undo', exact: true }).press('Enter');
  await seen(types);
  await seen(page.getByRole('region', { name: 'Files' }).getByText('unsaved'));

  // Somebody else's change is not written over.
  const wanted = semanticData.replace('"Person"', '"Person, Food"').replace(/\n}$/, ', \n    "segue": {\n        "effects": "[\\"+greeted()\\"]"\n    }\n}');
  const save = data.getByRole('button', { name: 'Save semantic data' });
  await save.press('Enter');
  await has('+greeted', 'the mission has the effect');
  assert.equal(onDisk(semanticFile), wanted, 'nothing else has changed');
  await seen(data.getByText('as in the file'));
  await types.fill('Animal');
  await page.keyboard.press('Enter');
  await seen(data.getByText('1 unsaved'));
  writeFileSync(file(semanticFile), semanticData);
  await save.press('Enter');
  await seen(data.getByRole('alert').filter({ hasText: 'changed by somebody else' }));
  assert.equal(onDisk(semanticFile), semanticData);
  await data.getByRole('button', { name: 'Read the file again' }).press('Enter');
  await holds(async () => (await types.inputValue()) === 'Person', 'the file is read again');
  await panel('say').getByRole('button', { name: 'Close' }).press('Enter');
}

/** Who may only look sees semantic data, and nothing to change them. */
async function observeSemanticData() {
  const studio = await stage.startStudio('--observe');
  const page = stage.watched(await stage.browser.newPage());
  await page.goto(studio.found);
  await page.getByRole('link', { name: 'Edit' }).press('Enter');
  const { seen, state, panel, open } = helpers(page);
  await open('machines/greet');
  await seen(state('say'));
  await state('say').focus();
  await page.keyboard.press('Enter');
  const data = panel('say').getByRole('region', { name: 'Semantic data' });
  await seen(data.getByLabel('RAFCONTPP › PDDL_ACTION › pddl_types', { exact: true }));
  assert.equal(await data.getByRole('button').count(), 0);
  assert.equal(await data.locator('input:not([readonly]), textarea:not([readonly]), select').count(), 0);
}

async function editFiles(page) {
  const { seen, has, problems, state, open } = helpers(page);
  // A machine of RAFCON is read only, and can be saved as a mission.
  await open('machines/greet');
  await seen(page.getByText('read only'));
  await has('mission: greet', 'the machine is a mission');
  await seen(state('say'));
  await problems.getByText('…').waitFor({ state: 'detached' });
  await capture(page, 'edit_rafcon');
  await page.getByRole('button', { name: 'Save as a mission …' }).press('Enter');
  await page.getByLabel('File of the mission').fill('missions/fetch.yaml');
  await page.keyboard.press('Enter');
  await seen(page.getByText('is there already'));
  await page.getByLabel('File of the mission').fill('missions/greet.yaml');
  await page.keyboard.press('Enter');
  await seen(page.getByRole('region', { name: 'Edit missions/greet.yaml' }));
  assert.match(onDisk('missions/greet.yaml'), /^mission: greet/);

  // A new mission has no problems; names are checked.
  await page.getByRole('button', { name: 'New mission' }).press('Enter');
  await page.getByLabel('File of the new mission').fill('../outside.yaml');
  await page.keyboard.press('Enter');
  await seen(page.getByText('cannot be the name of a file'));
  await page.getByLabel('File of the new mission').fill('missions/empty.yaml');
  await page.keyboard.press('Enter');
  await seen(page.getByRole('region', { name: 'Edit missions/empty.yaml' }));
  await seen(problems.getByText('No problems'));

  // A new controller outside of what the robot file names is added there, and follows its name.
  const robot = onDisk('robot.yaml');
  await page.getByRole('button', { name: 'New controller' }).press('Enter');
  await page.getByLabel('File of the new controller').fill('parked.yaml');
  await page.keyboard.press('Enter');
  await seen(page.getByRole('region', { name: 'Edit parked.yaml' }));
  assert.match(onDisk('robot.yaml'), /parked\.yaml/);
  await page.getByRole('button', { name: 'Rename …' }).press('Enter');
  await page.getByLabel('New name of the file').fill('controllers/parked.yaml');
  await page.keyboard.press('Enter');
  await seen(page.getByRole('region', { name: 'Edit controllers/parked.yaml' }));
  assert.equal(onDisk('robot.yaml'), robot, 'the pattern names it');
  await page.getByRole('button', { name: 'Delete …' }).press('Enter');
  await seen(problems.getByText('No problems'));
  await capture(page, 'edit_delete');
  await page.getByRole('button', { name: 'Delete the file' }).press('Enter');
  await seen(page.getByText('Choose a file at the left'));
  assert.ok(!existsSync(file('controllers/parked.yaml')));
}

await stage.play(async () => {
  stage.run(['init', 'rover']);
  mkdirSync(file('missions/tools'), { recursive: true });
  writeFileSync(file('missions/fetch.yaml'), mission);
  writeFileSync(file('missions/tools/store.yaml'), library);
  writeMachine();
  await stage.start(['run', 'rover/robot.yaml', '--controller', 'explore'], /robot rover runs/);
  const page = await stage.enter();
  await page.getByRole('link', { name: 'Edit' }).press('Enter');
  await editMission(page);
  await editNeeds(page);
  await editSemanticData(page);
  await editFiles(page);
  await observeSemanticData();
});
