// SPDX-License-Identifier: Apache-2.0
import { parse } from 'yaml';
import { describe, expect, it } from 'vitest';
import { addAction, addActionOutcome, addActionPort, addEntry, pathOf, removeActionOutcome, removeActionPort, runEntries, setActionPort, setDeclared, setEntry, setFlag, usersOf } from './mission_actions';
import { missionIn, stateIn } from './mission_text';

const text = `# Fetches the box.
mission: fetch
actions:
  look:   # sees
    outputs: {pose: map, near: bool}   # in the map's frame
    outcomes: [found, nothing]
    expect: {duration: 2s, outcome: found}   # mostly
    run: {simulated: {duration: 2s}}
  grasp:
    inputs: {pose: map, force: {type: float, default: 2.5}}
    preconditions: ["!holding(box)", "near({pose})"]
    effects: ["+holding(box)"]
    resources: [{block: arm}]
    run:
      controller: grasp   # slowly
      until:
        # whatever comes first
        - {task: arm, state: arrived}
        - {after: 1min}
  idle: {}
start: look
flows:
  - look.pose -> grasp.pose   # where it is
  - look.near -> again.near
states:
  look: {on: {found: grasp, nothing: both}}
  grasp: {inputs: {force: 3.0}, on: {success: return success}}
  both:
    start: again
    flows: [again.pose -> hold.pose]
    states:
      again: {action: look, on: {found: hold, nothing: return success}}
      hold: {action: grasp, on: {success: return success}}
    on: {success: look}
`;
const mission = (of = text) => missionIn(of)!;
const action = (name: string, of = text) => mission(of).actions.find((one) => one.name === name)!;
const state = (id: string) => stateIn(mission().machines[0]!.root, id)!;
const value = (of: string, name: string) => (parse(of) as { actions: Record<string, Record<string, unknown>> }).actions[name];
function difference(after: string): string[] {
  const old = text.split('\n');
  const now = after.split('\n');
  return [...old.filter((line) => !now.includes(line)).map((line) => '-' + line.trim()), ...now.filter((line) => !old.includes(line)).map((line) => '+' + line.trim())];
}

describe('what a container declares', () => {
  const both = (of: string) => (parse(of) as { states: { both: Record<string, unknown> } }).states.both;
  it('is set beside the rest of it', () => {
    const more = addEntry(text, state('both').path, 'preconditions', '!dark', 'text');
    expect(difference(more)).toEqual(['+preconditions: ["!dark"]']);
    const container = stateIn(mission(more).machines[0]!.root, 'both')!;
    expect(container.declares).toEqual({ preconditions: ['!dark'] });
    expect(both(setDeclared(more, container, ['preconditions', 0], 'lit()', 'text'))['preconditions']).toEqual(['lit()']);
    expect(both(setDeclared(more, container, ['preconditions', 0], '', 'text'))).toEqual(both(text));
    expect(both(addEntry(text, state('both').path, 'resources', '{block: arm}', 'yaml'))['resources']).toEqual([{ block: 'arm' }]);
  });
  it('are the world and the resources where it is the mission', () => {
    const root = mission().machines[0]!.root;
    const more = setDeclared(addEntry(text, root.path, 'world', 'at(robot, dock)', 'text'), root, ['resources', 'arm'], '{count: 2}', 'yaml');
    expect(parse(more)).toMatchObject({ world: ['at(robot, dock)'], resources: { arm: { count: 2 } } });
    expect(difference(more).every((line) => line.startsWith('+'))).toBe(true);
    const read = mission(more).machines[0]!.root;
    expect(read.declares).toEqual({ world: ['at(robot, dock)'], resources: { arm: { count: 2 } } });
    expect(parse(setDeclared(more, read, ['resources', 'arm'], '', 'yaml'))).not.toHaveProperty('resources');
    expect(state('look').declares).toEqual({});
  });
});

describe('what an action declares', () => {
  it('is set in its place, and nothing else changes', () => {
    expect(difference(setEntry(text, action('look'), ['expect', 'duration'], '500ms', 'yaml'))).toEqual(['-expect: {duration: 2s, outcome: found}   # mostly', '+expect: {duration: 500ms, outcome: found}   # mostly']);
    expect(difference(setEntry(text, action('grasp'), ['run', 'controller'], 'grip', 'yaml'))).toEqual(['-controller: grasp   # slowly', '+controller: grip   # slowly']);
    expect(difference(setEntry(text, action('look'), ['run', 'simulated', 'outcomes'], '[nothing, found]', 'yaml'))[1]).toBe('+run: {simulated: {duration: 2s, outcomes: [nothing, found]}}');
    expect(value(setEntry(text, action('look'), ['description'], 'sees: all', 'text'), 'look')?.['description']).toBe('sees: all');
  });

  it('has facts and resources', () => {
    expect(difference(setEntry(text, action('grasp'), ['preconditions', 0], '!held(box)', 'text'))[1]).toBe('+preconditions: ["!held(box)", "near({pose})"]');
    expect(value(addEntry(text, pathOf(action('look')), 'while', '!near(goal)', 'text'), 'look')?.['while']).toEqual(['!near(goal)']);
    expect(difference(addEntry(text, pathOf(action('grasp')), 'resources', '{consume: cup, count: 2}', 'yaml'))[1]).toBe('+resources: [{block: arm}, {consume: cup, count: 2}]');
    const fewer = setEntry(text, action('grasp'), ['preconditions', 1], '', 'text');
    expect(value(fewer, 'grasp')?.['preconditions']).toEqual(['!holding(box)']);
    expect(difference(setEntry(text, action('grasp'), ['effects', 0], '', 'text'))).toEqual(['-effects: ["+holding(box)"]']);
  });

  it('is taken out with what would be left empty around it', () => {
    const once = setEntry(text, action('look'), ['expect', 'duration'], '', 'yaml');
    expect(value(once, 'look')?.['expect']).toEqual({ outcome: 'found' });
    const twice = setEntry(once, action('look', once), ['expect', 'outcome'], '', 'text');
    expect(value(twice, 'look')).not.toHaveProperty('expect');
    expect(value(setEntry(text, action('look'), ['run', 'simulated', 'duration'], '', 'yaml'), 'look')?.['run']).toEqual({ simulated: {} });
    expect(() => setEntry(text, action('grasp'), ['run', 'controller'], '', 'yaml')).toThrow('nothing');
    expect(setEntry(text, action('idle'), ['description'], '', 'text')).toBe(text);
  });

  it('loses no comments of what is written over several lines', () => {
    expect(() => setEntry(text, action('grasp'), ['run', 'until'], '[{after: 1s}]', 'yaml')).toThrow('several lines');
  });

  it('has flags', () => {
    const pure = setFlag(text, action('idle'), 'pure', true);
    expect(difference(pure)).toEqual(['-idle: {}', '+idle:', '+pure: true']);
    expect(value(setFlag(pure, action('idle', pure), 'pure', false), 'idle')).toEqual({});
  });

  it('says what it runs in parts', () => {
    expect(runEntries(action('look')).map((one) => one.label)).toEqual(['simulated duration', 'simulated outcomes', 'simulated outputs', 'simulated error']);
    expect(runEntries(action('grasp')).map((one) => [one.label, one.value]).slice(0, 2)).toEqual([['controller', 'grasp'], ['set', undefined]]);
    expect(runEntries(action('idle'))).toEqual([]);
  });
});

describe('ports and outcomes of an action', () => {
  it('come, change and go with what uses them', () => {
    expect(value(addActionPort(text, action('look'), 'inputs', 'box', 'text'), 'look')?.['inputs']).toEqual({ box: 'text' });
    expect(() => addActionPort(text, action('grasp'), 'inputs', 'pose', 'map')).toThrow();
    const [pose, force] = action('grasp').inputs;
    expect(difference(setActionPort(text, action('grasp'), 'inputs', pose!, 'any', ''))[1]).toBe('+inputs: {pose: any, force: {type: float, default: 2.5}}');
    expect(difference(setActionPort(text, action('grasp'), 'inputs', force!, 'float', '4'))[1]).toBe('+inputs: {pose: map, force: {type: float, default: 4}}');
    expect(difference(removeActionPort(text, mission(), action('grasp'), 'inputs', 'force'))).toEqual([
      '-inputs: {pose: map, force: {type: float, default: 2.5}}', '-grasp: {inputs: {force: 3.0}, on: {success: return success}}',
      '+inputs: {pose: map}', '+grasp: {on: {success: return success}}',
    ]);
    // Flows from its states in all containers go, those to inputs of the same name stay.
    const without = missionIn(removeActionPort(text, mission(), action('look'), 'outputs', 'pose'))!.machines[0]!.root;
    expect(without.flows).toEqual([{ from: 'look.near', to: 'again.near' }]);
    expect(stateIn(without, 'both')!.flows).toEqual([]);
  });

  it('has outcomes', () => {
    expect(usersOf(mission(), action('look')).map((one) => one.id)).toEqual(['look', 'both/again']);
    expect(value(addActionOutcome(text, action('grasp'), 'slipped'), 'grasp')?.['outcomes']).toEqual(['success', 'slipped']);
    const fewer = removeActionOutcome(text, mission(), action('look'), 'found');
    expect(value(fewer, 'look')).toMatchObject({ outcomes: ['nothing'], expect: { duration: '2s' } });
    expect(missionIn(fewer)!.machines[0]!.root.children[0]!.on).toEqual([{ outcome: 'nothing', target: 'both' }]);
    expect(stateIn(missionIn(fewer)!.machines[0]!.root, 'both/again')!.on).toEqual([{ outcome: 'nothing', target: 'return success' }]);
    expect(() => removeActionOutcome(text, mission(), action('grasp'), 'success')).toThrow('one outcome');
  });

  it('can be a new one', () => {
    const added = addAction(text, mission(), state('look'), 'search');
    expect(value(added, 'search')).toEqual({ run: { simulated: { duration: '1s' } } });
    expect(stateIn(missionIn(added)!.machines[0]!.root, 'look')!.action).toBe('search');
    for (const name of ['look', '', 'a b']) expect(() => addAction(text, mission(), state('look'), name)).toThrow();
  });
});
