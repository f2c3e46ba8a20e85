// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Action, RobotEvent } from '../robot/types';
import { undoingOf, undoneOf } from './undo';

function event(number: number, kind: string, subject: string, message = ''): RobotEvent {
  return { number, time: '', kind, subject, message };
}

const events = [
  event(1, 'transition_undone', 'old', 'of an earlier request'),
  event(2, 'action_done', 'start a'),
  event(3, 'action_done', 'connect a.out -> b.in (data)'),
  event(4, 'transition_undone', 'target', 'cancelled by ann; going back to "before"'),
  event(5, 'action_done', 'stop a'),
  event(6, 'action_failed', 'cleanup a'),
  event(7, 'action_done', 'disconnect a.out -> b.in (data)'),
  event(8, 'transition_failed', 'target'),
  event(9, 'action_done', 'stop c'),
];

describe('undoing', () => {
  it('lists what was done to undo the request, and nothing before or behind it', () => {
    const undoing = undoingOf(events, 1);
    expect(undoing.why).toBe('cancelled by ann; going back to "before"');
    expect(undoing.steps.map((step) => [step.subject, step.done])).toEqual([
      ['stop a', true], ['cleanup a', false], ['disconnect a.out -> b.in (data)', true],
    ]);
    expect(undoingOf(events, 8)).toEqual({ why: null, steps: [] });
    expect(undoingOf([], 0).why).toBeNull();
  });

  it('marks the actions whose opposite was done', () => {
    const actions: Action[] = [
      { id: 1, kind: 'configure', after: [], task: 'a' },
      { id: 2, kind: 'start', after: [], task: 'a' },
      { id: 3, kind: 'connect', after: [], from: 'a.out', to: 'b.in' },
      { id: 4, kind: 'start', after: [], task: 'c' },
      { id: 5, kind: 'recover', after: [], task: 'a' },
    ];
    expect([...undoneOf(actions, undoingOf(events, 1))]).toEqual([2, 3]);
  });
});
