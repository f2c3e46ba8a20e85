// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { endsOf, filmOf, frameOf, frameOfNetwork, groupsOf, momentOf, networkOf, phasesOf, taskOfAction, type PastAction, type PastTransition } from './film';

function action(label: string, started: number, ended: number, outcome = 'done'): PastAction {
  return {
    id: started, kind: label.split(' ')[0] ?? '', phase: 'commit', label, started_s: started, duration_s: 0.1, ended_s: ended, outcome, host: '', process: '',
  };
}

const task = (id: string, state = 'running') => ({ id, component: 'demo::A', state, host: 'onboard', process: 'p' });
const before = { tasks: [task('a'), task('b')], connections: [{ from: 'a.out', to: 'b.in' }] };
const after = { tasks: [task('b'), task('c')], connections: [{ from: 'c.out', to: 'b.in' }] };

const transition: PastTransition = {
  id: 7, from: 'one', to: 'two', runs: 'two', outcome: 'done', who: '', ended_s: 100, lasted_s: 6,
  actions: [
    action('configure c', 0, 1), action('disconnect a.out -> b.in', 1, 2), action('connect c.out -> b.in (data)', 2, 3), action('start c', 3, 4),
    action('stop a', 4, 4.5), action('cleanup a', 4.5, 5),
  ],
  undo_actions: [], before: JSON.stringify(before), after: JSON.stringify(after),
};

const taskAt = (at: number, id: string) => frameOf(filmOf(transition), at).tasks.find((one) => one.id === id);
const edgeAt = (at: number, id: string) => frameOf(filmOf(transition), at).edges.find((one) => one.id === id);

describe('a film', () => {
  it('shows actions coming true at their times', () => {
    expect(filmOf(transition).length).toBe(6);
    expect(taskAt(0.5, 'c')).toMatchObject({ fate: 'added', presence: 'not yet' });
    expect(taskAt(1, 'c')).toMatchObject({ presence: 'there', state: 'stopped' });
    expect(taskAt(4, 'c')).toMatchObject({ state: 'running' });
    expect(taskAt(4, 'a')).toMatchObject({ fate: 'removed', presence: 'there', state: 'running', place: 'onboard / p' });
    expect(taskAt(5, 'a')).toMatchObject({ presence: 'gone' });
    expect(taskAt(5, 'b')).toMatchObject({ fate: 'unchanged', presence: 'there', state: 'running' });
    expect(edgeAt(1.5, 'a -> b')).toMatchObject({ fate: 'removed', presence: 'there' });
    expect(edgeAt(2, 'a -> b')?.presence).toBe('gone');
    expect(edgeAt(2.5, 'c -> b')?.presence).toBe('not yet');
    expect(edgeAt(3, 'c -> b')).toMatchObject({ fate: 'added', presence: 'there' });
    expect(frameOf(filmOf(transition), 6).tasks.filter((one) => one.presence === 'there').map((one) => one.id)).toEqual(['b', 'c']);
  });

  it('shows what was undone', () => {
    const undone: PastTransition = {
      ...transition, outcome: 'cancelled', after: transition.before,
      actions: [action('configure c', 0, 1), action('disconnect a.out -> b.in', 1, 2), action('start c', 9, 9, 'skipped')],
      undo_actions: [action('connect a.out -> b.in', 3, 4), action('cleanup c', 4, 5)],
    };
    const film = filmOf(undone);
    expect(film.steps.length).toBe(4);
    expect(frameOf(film, 2).edges.find((one) => one.id === 'a -> b')).toMatchObject({ fate: 'changed', presence: 'gone' });
    expect(frameOf(film, 4).edges.find((one) => one.id === 'a -> b')?.presence).toBe('there');
    expect(frameOf(film, 2).tasks.find((one) => one.id === 'c')?.presence).toBe('there');
    expect(frameOf(film, 5).tasks.find((one) => one.id === 'c')?.presence).toBe('gone');
  });

  it('does without networks that were not recorded', () => {
    const film = filmOf({ ...transition, before: null, after: null, lasted_s: null });
    expect(film.length).toBe(5);
    expect(frameOf(film, 0).tasks.map((one) => [one.id, one.state])).toEqual([['c', 'not known'], ['a', 'not known']]);
    expect(frameOf(film, 5).edges.map((one) => [one.id, one.presence])).toEqual([['a -> b', 'gone'], ['c -> b', 'there']]);
  });

  it('names processes as the view Network does', () => {
    const places = [['localhost', 'sensors'], ['base', 'arm'], ['', '']] as const;
    const tasks = places.map(([host, process], index) => ({ ...task('task' + index), host, process }));
    expect(groupsOf(frameOfNetwork({ tasks, connections: [] })).map((group) => group.title)).toEqual(['runtime', 'base / arm', 'sensors']);
  });

  it('reads labels and networks', () => {
    expect(endsOf('connect a.b.out -> c.in (data, shared)')).toEqual(['a.b.out', 'c.in']);
    expect(endsOf('start a')).toBeNull();
    expect(taskOfAction(action('start <b>', 0, 1))).toBe('<b>');
    expect(taskOfAction(action('deploy host/p', 0, 1))).toBeNull();
    expect(networkOf(null)).toBeNull();
    expect(networkOf('{')).toBeNull();
    expect(networkOf('[]')).toBeNull();
    expect(frameOfNetwork(before).edges).toEqual([{ id: 'a -> b', source: 'a', target: 'b', fate: 'unchanged', presence: 'there' }]);
  });

  it('has phases, as far as something was done in them', () => {
    const actions = transition.actions.map((one, index) => ({ ...one, phase: index === 0 ? 'prepare' : index < 4 ? 'commit' : 'retire' }));
    expect(phasesOf(filmOf({ ...transition, actions }))).toEqual([{ phase: 'prepare', from: 0, to: 1 }, { phase: 'commit', from: 1, to: 4 }, { phase: 'retire', from: 4, to: 5 }]);
    const undone = { ...transition, actions: [actions[0]!, { ...actions[5]!, outcome: 'skipped' }], undo_actions: [action('cleanup c', 2, 3)] };
    expect(phasesOf(filmOf(undone)).map((one) => one.phase)).toEqual(['prepare', 'undo']);
  });

  it('knows when an action ran', () => {
    const one = action('start a', 1, 2, 'failed');
    expect([0, 1, 2].map((at) => momentOf(one, at))).toEqual(['waiting', 'running', 'failed']);
    expect(momentOf({ ...one, outcome: 'skipped' }, 5)).toBe('skipped');
  });
});
