// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';
import { entries, mission } from '../missions/testing';
import type { Plan } from '../missions/mission';
import type { Json } from '../robot/change';
import { holdersOf, unitsText } from './units_text';

const nobody = new Map<string, string[]>();

test('units have their names and counts, and who holds some', () => {
  const units = { units: { screws: { name: 'screws', count: 40 }, cups: { name: 'cups', count: 0 } } };
  expect(unitsText(units, nobody)).toBe('cups 0, screws 40');
  expect(unitsText(units, new Map([['screws', ['2 by m: a', '1 by m: b']]]))).toBe('cups 0, screws 40 (held: 2 by m: a, 1 by m: b)');
});

test('a robot that keeps none, or is not known, has nothing to say', () => {
  expect([undefined, { units: {} }, null].map((document) => unitsText(document, nobody))).toEqual(['', '', '']);
});

test('states hold what they take while they run', () => {
  const state = (path: string, units?: { name: string; count: number }[]) => ({ path, title: path, kind: 'action', next: [], ...(units && { units }) });
  const plan: Plan = { mission: 'm', complete: true, nodes: null, states: [state(''), state('a', [{ name: 'screws', count: 2 }]), state('b', [{ name: 'screws', count: 1 }, { name: 'cups', count: 1 }]), state('c')] };
  const held = (state_: string, ...list: [string, string?][]) => [...holdersOf(mission(null, { state: state_, plan, entries: entries(...list) }) as unknown as Json)];
  expect(held('running', ['a'], ['b'], ['c'])).toEqual([['screws', ['2 by m: a', '1 by m: b']], ['cups', ['1 by m: b']]]);
  expect(held('running', ['a'], ['a', 'success'], ['b'])).toEqual([['screws', ['1 by m: b']], ['cups', ['1 by m: b']]]);
  expect(held('ended', ['a'])).toEqual([]);
  expect([...holdersOf(undefined)]).toEqual([]);
});
