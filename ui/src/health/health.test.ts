// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';
import type { Trouble } from '../robot/types';
import { howLong, isInTrouble, stateText, troubleOfTask, troublesOf } from './health';

const slam: Trouble = { kind: 'task', name: 'slam', what: "task 'slam' is exception", why: 'too hot', since: '', for_s: 3, repair: '`segue repair` repairs it', on_request: true };
const base = { state: 'idle', lost: null };

test('a healthy robot says what its runtime does', () => {
  expect(stateText({ ...base, health: { state: 'healthy', troubles: [] } })).toBe('idle');
  expect(stateText({ ...base })).toBe('idle');
});

test('a robot that lacks something is not idle', () => {
  expect(stateText({ ...base, health: { state: 'in_trouble', troubles: [slam] } })).toBe('in trouble: 1 part is missing or faulty');
  expect(stateText({ ...base, health: { state: 'in_trouble', troubles: [slam, slam] } })).toBe('in trouble: 2 parts are missing or faulty');
});

test('a robot that another runtime has got is lost', () => {
  const status = { ...base, lost: 'a rival has it', health: { state: 'lost' as const, troubles: [] } };
  expect(stateText(status)).toBe('lost');
  expect(isInTrouble(status)).toBe(true);
});

test('during a transition nothing is missing yet', () => {
  const status = { ...base, health: { state: 'in_transition' as const, troubles: [slam] } };
  expect(isInTrouble(status)).toBe(false);
  expect(troublesOf(status)).toEqual([]);
});

test('a task is found among the troubles', () => {
  const status = { health: { state: 'in_trouble' as const, troubles: [{ ...slam, kind: 'process', name: 'slam' }, slam] } };
  expect(troubleOfTask(status, 'slam')).toBe(slam);
  expect(troubleOfTask(status, 'laser')).toBeUndefined();
});

test('durations are as exact as a person needs them', () => {
  expect([-1, 3.4, 99, 100, 7200, 2 * 86400].map(howLong)).toEqual(['0 s', '3 s', '99 s', '2 min', '2 h', '2 days']);
});
