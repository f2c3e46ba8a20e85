// SPDX-License-Identifier: Apache-2.0
import { parse } from 'yaml';
import { describe, expect, it } from 'vitest';
import { addFlow, addOutcome, addPort, addState, moveState, removeFlow, removeOutcome, removePort, removeState, renameState, setKind, setPort, setStart, setText, setTransition, setUse, setValue } from './mission_edits';
import { allLibraries, flowRefusal, interfaceIn, missionIn, newName, outcomesIn, stateIn, statesOf, targetsOf, type EditedState } from './mission_text';

const text = `# Fetches the box.
mission: fetch
actions:
  look:   # sees
    outputs: {pose: map}
    outcomes: [found, nothing]
    description: looks around
  grasp: {inputs: {pose: map, force: float}}
  judge: {run: {decide: [{when: {left: success}, outcome: success}]}}
outcomes: [done, failed]
start: look
flows:
  - look.pose -> grasp.pose   # where it is
states:
  # first of all
  look: {on: {found: grasp, nothing: both}}
  grasp:
    inputs: {force: 2}
    on:
      success: return done   # it has it
      aborted: look
  both:
    kind: barrier
    states:
      left: {action: look, on: {}}
      decide: {action: judge, kind: decider, on: {success: return success}}
    on: {success: look}
libraries:
  tools:
    inputs: {pose: map}
    start: look
    states:
      look: {on: {found: return success, nothing: return success}}
`;
const read = (from: string) => missionIn(from)!;
const root = (from: string) => read(from).machines[0]!.root;
const state = (from: string, id: string) => stateIn(root(from), id)!;
function difference(before: string, after: string): string[] {
  const old = before.split('\n');
  const now = after.split('\n');
  return [...old.filter((line) => !now.includes(line)).map((line) => '-' + line), ...now.filter((line) => !old.includes(line)).map((line) => '+' + line)];
}

describe('missionIn', () => {
  it('finds states, ports and outcomes', () => {
    const mission = read(text);
    expect(statesOf(root(text)).map((one) => one.id + ' ' + one.kind)).toEqual([' hierarchy', 'look execution', 'grasp execution', 'both barrier', 'both/left execution', 'both/decide decider']);
    expect(outcomesIn(mission, [], state(text, 'grasp'))).toEqual(['success', 'aborted']);
    expect(interfaceIn(mission, [], state(text, 'both/left'))?.outputs).toEqual([{ name: 'pose', type: 'map' }]);
    expect(targetsOf(state(text, 'look'))).toEqual(['look', 'grasp', 'both', 'return done', 'return failed', 'return aborted', 'return preempted']);
    expect(targetsOf(state(text, 'both/left'))[0]).toBe('return success');
    expect(allLibraries(mission, []).map((one) => one.name)).toEqual(['tools']);
    expect(text.slice(state(text, 'grasp').at).startsWith('grasp:')).toBe(true);
    for (const other of ['', 'mission: [', '[1]', 'network: a\n']) expect(missionIn(other)).toBeNull();
  });
  it('says what values can flow', () => {
    const mission = read(text);
    expect(flowRefusal(mission, [], root(text), 'look.pose', 'grasp.force')).toContain('type');
    expect(flowRefusal(mission, [], root(text), 'look.pose', 'grasp.pose')).toContain('already');
    expect(flowRefusal(mission, [], root(text), 'grasp.pose', 'look.pose')).toContain('no values');
  });
});

describe('edits touch nothing else', () => {
  it('adds states', () => {
    expect(difference(text, addState(text, root(text), 'grasp_2', { action: 'grasp' }))).toEqual(['+  grasp_2: {action: grasp}']);
    expect(difference(text, addState(text, root(text), 'inner', { kind: 'preemptive' }))).toEqual(['+  inner:', '+    kind: preemptive', '+    states: {}']);
    const within = addState(text, root(text), 'inner', { kind: 'hierarchy' });
    const both = addState(within, state(within, 'inner'), 'look', { action: 'look' });
    expect(difference(text, both)).toEqual(['+  inner:', '+      look: {}']);
    expect(state(both, 'inner').start).toBe('look');
    expect(newName(root(text), 'look')).toBe('look_2');
    for (const name of ['a.b', 'inputs', 'look', '', '<b>']) expect(() => addState(text, root(text), name, { action: 'look' })).toThrow();
  });
  it('removes a state with what names it', () => {
    expect(difference(text, removeState(text, state(text, 'grasp')))).toEqual([
      '-flows:', '-  - look.pose -> grasp.pose   # where it is', '-  look: {on: {found: grasp, nothing: both}}', '-  grasp:', '-    inputs: {force: 2}', '-    on:',
      '-      success: return done   # it has it', '-      aborted: look', '+flows: []', '+  look: {on: {nothing: both}}',
    ]);
  });
  it('renames a state with all that names it', () => {
    const renamed = renameState(text, read(text), state(text, 'look'), 'search');
    expect(difference(text, renamed)).toEqual([
      '-start: look', '-  - look.pose -> grasp.pose   # where it is', '-  look: {on: {found: grasp, nothing: both}}', '-      aborted: look', '-    on: {success: look}',
      '+start: search', '+  - search.pose -> grasp.pose   # where it is', '+  search: {on: {found: grasp, nothing: both}, action: look}', '+      aborted: search', '+    on: {success: search}',
    ]);
    expect(renameState(text, read(text), state(text, 'both/left'), 'right')).toContain('{when: {right: success}, outcome: success}');
    expect(() => renameState(text, read(text), state(text, 'look'), 'grasp')).toThrow('already');
  });
  it('moves a state', () => {
    const inside = moveState(text, state(text, 'grasp'), state(text, 'both'), 'decide');
    expect(parse(inside)).toMatchObject({ states: { both: { states: { grasp: { inputs: { force: 2 } } } } } });
    expect(state(inside, 'both').children.map((one) => one.name)).toEqual(['left', 'grasp', 'decide']);
    expect(state(inside, 'both/grasp').on).toEqual([]);
    const last = moveState(text, state(text, 'look'), root(text), null);
    expect(root(last).children.map((one) => one.name)).toEqual(['grasp', 'both', 'look']);
    expect(difference(text, last)).toEqual([]);
  });
  it('sets transitions, start, values and texts', () => {
    expect(difference(text, setTransition(text, state(text, 'look'), 'found', 'return failed'))).toEqual(['-  look: {on: {found: grasp, nothing: both}}', '+  look: {on: {found: return failed, nothing: both}}']);
    expect(difference(text, setTransition(text, state(text, 'grasp'), 'success', 'both'))).toEqual(['-      success: return done   # it has it', '+      success: both   # it has it']);
    expect(difference(text, setTransition(text, state(text, 'both'), 'success', null))).toEqual(['-    on: {success: look}']);
    expect(difference(text, setStart(text, root(text), 'grasp'))).toContain('+start: grasp');
    expect(difference(text, setValue(text, state(text, 'grasp'), 'inputs', 'force', '3.5'))).toEqual(['-    inputs: {force: 2}', '+    inputs: {force: 3.5}']);
    expect(difference(text, setValue(text, state(text, 'grasp'), 'inputs', 'force', ''))).toEqual(['-    inputs: {force: 2}']);
    expect(parse(setText(text, state(text, 'look'), 'title', 'a: b # c'))).toMatchObject({ states: { look: { title: 'a: b # c' } } });
    expect(state(setKind(text, state(text, 'both'), 'hierarchy'), 'both').kind).toBe('hierarchy');
    expect(difference(text, setKind(text, state(text, 'both/left'), 'decider'))).toEqual(['-      left: {action: look, on: {}}', '+      left: {action: look, on: {}, kind: decider}']);
    expect(difference(text, setKind(text, state(text, 'both/decide'), 'execution'))).toEqual(['-      decide: {action: judge, kind: decider, on: {success: return success}}', '+      decide: {action: judge, on: {success: return success}}']);
    expect(difference(text, setUse(text, state(text, 'both/left'), 'grasp'))).toEqual(['-      left: {action: look, on: {}}', '+      left: {action: grasp, on: {}}']);
  });
  it('adds and removes flows, outcomes and ports', () => {
    expect(difference(text, addFlow(text, root(text), 'look.pose', 'grasp.force'))).toEqual(['+  - look.pose -> grasp.force']);
    expect(removeFlow(text, root(text), 0)).toContain('flows: []');
    expect(difference(text, addOutcome(text, root(text), 'lost'))).toEqual(['-outcomes: [done, failed]', '+outcomes: [done, failed, lost]']);
    expect(difference(text, removeOutcome(text, root(text), 'done'))).toEqual(['-outcomes: [done, failed]', '-      success: return done   # it has it', '+outcomes: [failed]']);
    const port = addPort(text, state(text, 'both'), 'inputs', 'box', 'text');
    expect(difference(text, port)).toEqual(['+    inputs: {box: text}']);
    expect(difference(port, setPort(port, state(port, 'both'), 'inputs', { name: 'box', type: 'text' }, 'text', 'red'))).toEqual(['-    inputs: {box: text}', '+    inputs: {box: {type: text, default: red}}']);
    const flowing = addFlow(port, root(port), 'look.pose', 'both.box');
    expect(removePort(flowing, state(flowing, 'both'), 'inputs', 'box')).toBe(text);
  });
});

describe('random edits', () => {
  it('keep comments, and leave no name that leads nowhere', () => {
    for (let seed = 1; seed <= 12; ++seed) {
      let random = seed;
      const next = (below: number) => {
        random = (Math.imul(random, 1664525) + 1013904223) >>> 0;
        return Math.floor((random / 2 ** 32) * below);
      };
      let now = text;
      for (let i = 0; i < 8; ++i) {
        const mission = read(now);
        const all = statesOf(mission.machines[0]!.root);
        const one = all[1 + next(Math.max(1, all.length - 1))];
        const containers = all.filter((each) => ['hierarchy', 'barrier', 'preemptive'].includes(each.kind));
        const into = containers[next(containers.length)]!;
        const what = next(5);
        const before = now;
        if (what === 0) now = addState(now, into, newName(into, 'look'), next(2) ? { action: 'look' } : { kind: 'hierarchy' });
        if (what === 1 && one) now = renameState(now, mission, one, newName(one.parent!, 'other'));
        if (what === 2 && one && !into.id.startsWith(one.id) && !into.children.some((each) => each.name === one.name)) now = moveState(now, one, into, null);
        if (what === 3 && one) {
          const targets = targetsOf(one);
          now = setTransition(now, one, 'found', targets[next(targets.length)] ?? null);
        }
        if (what === 4 && one) now = setValue(now, one, 'inputs', 'pose', '{x: ' + next(9) + '}');
        const where = 'seed ' + seed + ' step ' + what + ' of\n' + before + '\nto\n' + now;
        const names = (each: EditedState) => each.children.map((child) => child.name);
        for (const each of statesOf(root(now))) {
          if (each.parent) for (const { target } of each.on) if (!target.startsWith('return ')) expect(names(each.parent), where).toContain(target);
          if (each.start && !each.start.startsWith('return ')) expect(names(each), where).toContain(each.start);
          for (const flow of each.flows) if (flow) for (const ref of [flow.from, flow.to]) expect([...names(each), 'inputs', 'outputs'], where).toContain(ref.split('.')[0]);
        }
        for (const comment of ['# Fetches the box.', '# sees', '# first of all']) expect(now, where).toContain(comment);
      }
    }
  }, 100000);
});
