// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { defaultText, givenInputs, inputProblem, missionsIn, problemsOf, startedOf, type MissionForm } from './start';

const form: MissionForm = {
  mission: 'fetch', description: '', needs_robot: true,
  inputs: [{ name: 'what', type: 'text', default: 'cup' }, { name: 'count', type: 'int', default: 2 }, { name: 'place', type: 'map', default: { x: 1 } }, { name: 'any', type: 'any', default: null }],
};

describe('the missions that can be started', () => {
  it('are those among the files that can be read', () => {
    const file = (path: string, kind: string, problem = '') => ({ path, kind, named: true, problem });
    expect(missionsIn({ files: [file('robot.yaml', 'robot'), file('a.yaml', 'mission'), file('b.yaml', 'mission', 'too large'), file('m', 'rafcon')] })).toEqual(['a.yaml']);
    expect(missionsIn(null)).toEqual([]);
  });
});

describe('the fields of a form', () => {
  it('show the defaults', () => {
    expect(form.inputs.map(defaultText)).toEqual(['cup', '2', '{"x":1}', '']);
  });

  it('are sent where somebody has edited them', () => {
    expect(givenInputs(form, {})).toEqual({});
    expect(givenInputs(form, { what: '', count: ' ', place: '{x: 2}' })).toEqual({ what: '', place: '{x: 2}' });
  });

  it('say what cannot be meant', () => {
    expect(problemsOf(form, { what: '7', count: 'many', place: 'here' })).toEqual({ count: 'a whole number is needed, such as 3', place: 'a map is needed, such as {x: 1, y: 2}' });
    expect(problemsOf(form, { count: ' -3 ', place: 'x: 1' })).toEqual({});
    for (const good of ['1', '0.5', '-.5', '1e3', '.inf', '']) expect(inputProblem('float', good), good).toBe(null);
    for (const bad of ['a', '1,5', '1 m', '.', 'true']) expect(inputProblem('float', bad), bad).not.toBe(null);
    expect(inputProblem('list', '[1, 2]')).toBe(null);
    expect(inputProblem('list', '1, 2')).not.toBe(null);
    expect(inputProblem('pose', 'anything')).toBe(null);
  });
});

describe('the answer to a start', () => {
  it('tells problems by the input', () => {
    expect(startedOf({ problems: { count: 'no number' } })).toEqual({ problems: { count: 'no number' } });
  });

  it('is the run of a simulation, or none', () => {
    expect(startedOf({ run: null })).toBe('begun');
    const started = startedOf({ run: { name: 'fetch', makespan_s: 3, nodes: [{ name: 'look', start_s: 0, end_s: 3, status: 'done' }] } });
    expect(started).toMatchObject({ simulated: { name: 'fetch', ended: true, until: 3, rows: [{ label: 'look', status: 'done' }] } });
    expect(() => startedOf({ run: { name: 'fetch' } })).toThrow('this is not a run');
  });
});
