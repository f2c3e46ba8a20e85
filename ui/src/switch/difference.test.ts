// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Status, TaskStatus, Transition } from '../robot/types';
import { differenceOf, progressOf } from './difference';

const task = (id: string) => ({ id, host: '', process: '', state: 'running' }) as TaskStatus;
const connection = (from: string, to: string) => ({ from, to, policy: 'data', size: 1, written: 0, read: 0, dropped: 0 });
const status = {
  tasks: { drive: task('drive'), laser: task('laser'), wanderer: task('wanderer') },
  connections: { a: connection('laser.scan', 'wanderer.scan'), b: connection('wanderer.command', 'drive.command') },
} as unknown as Status;
const transition: Transition = {
  from: 'explore',
  to: 'go_to',
  removes: ['wanderer'],
  actions: [
    { id: 1, kind: 'apply_config', task: 'guard', phase: 'prepare', after: [] },
    { id: 2, kind: 'connect', from: 'guard.safe', to: 'drive.command', phase: 'prepare', after: [1] },
    { id: 3, kind: 'start', task: 'guard', phase: 'commit', after: [1, 2] },
    { id: 4, kind: 'apply_config', task: 'drive', phase: 'commit', after: [] },
    { id: 5, kind: 'disconnect', from: 'wanderer.command', to: 'drive.command', phase: 'retire', after: [] },
  ],
};

describe('the difference', () => {
  it('says of each task what becomes of it', () => {
    const fates = Object.fromEntries(differenceOf(status, transition).tasks.map((one) => [one.id, one.fate]));
    expect(fates).toEqual({ drive: 'changed', laser: 'unchanged', wanderer: 'removed', guard: 'added' });
  });
  it('says of each edge what becomes of it', () => {
    const fates = Object.fromEntries(differenceOf(status, transition).edges.map((one) => [one.id, one.fate]));
    expect(fates).toEqual({ 'laser -> wanderer': 'unchanged', 'wanderer -> drive': 'removed', 'guard -> drive': 'added' });
  });
  it('follows events', () => {
    const event = (number: number, kind: string, subject: string) => ({ number, kind, subject, time: '', message: '' });
    const progress = progressOf(
      transition.actions,
      [event(1, 'action_done', 'start guard'), event(5, 'action_done', 'apply_config guard'), event(6, 'action_failed', 'connect guard.safe -> drive.command')],
      4,
    );
    expect([...progress.values()]).toEqual(['done', 'failed', 'waiting', 'waiting', 'waiting']);
  });
  it('knows calls of operations by what events call them', () => {
    const call = { id: 1, kind: 'call_operation', task: 'odometry', operation: 'reset', after: [] };
    const told = [{ number: 1, kind: 'action_done', subject: 'call_operation odometry.reset', time: '', message: '' }];
    expect(progressOf([call], told, 0).get(1)).toBe('done');
  });
  it('does not take what undoes it for progress', () => {
    const event = (number: number, kind: string, subject: string) => ({ number, kind, subject, time: '', message: '' });
    const told = [event(1, 'action_failed', 'start guard'), event(2, 'transition_undone', 'go_to'), event(3, 'action_done', 'start guard')];
    expect(progressOf(transition.actions, told, 0).get(3)).toBe('failed');
  });
});
