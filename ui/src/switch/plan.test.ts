// SPDX-License-Identifier: Apache-2.0
import { createElement } from 'react';
import { renderToStaticMarkup } from 'react-dom/server';
import { expect, test } from 'vitest';
import type { PlannedTransition } from '../robot/types';
import { countsText, typicalOf, unmeasuredText } from './plan';
import { Changes, Phases, PlanSummary } from './Plan';

const range = (low: number, typical: number, high: number) => ({ low, typical, high });
const transition: PlannedTransition = {
  from: 'explore', to: 'go_to', order: 'seamless',
  actions: [
    { id: 1, kind: 'configure', task: 'seeker', phase: 'prepare', after: [] },
    { id: 2, kind: 'connect', from: 'seeker.command', to: 'guard.command', policy: 'circular_buffer', size: 4, phase: 'prepare', after: [] },
    { id: 3, kind: 'start', task: 'seeker', phase: 'commit', after: [1, 2] },
  ],
  counts: { stop: 0, configure: 1, connect: 1, start: 1, state_changes: 2, total: 3 },
  changes: ["task 'guard': property 'distance': not set -> 0.3"],
  estimate_s: {
    total: range(0.001, 0.002, 0.004), prepare: range(0.0005, 0.001, 0.002), commit: range(0.0001, 0.0002, 0.0003), retire: range(0, 0, 0),
    actions: [0.0005, 0.00001, 0.0002], critical_path: [1, 3], never_measured: 1,
  },
};
const textOf = (markup: string) => markup.replace(/<!-- -->/g, '').replace(/<[^>]*>/g, ' ').replace(/\s+/g, ' ').trim();
const phases = () => renderToStaticMarkup(createElement(Phases, { transition, progress: new Map(), undone: new Set<number>() }));

test('actions are counted by kind', () => {
  expect(countsText(transition.counts)).toBe('configure 1, connect 1, start 1');
  expect(countsText(undefined)).toBe('');
});

test('what was never measured is said', () => {
  expect(unmeasuredText(0, 3)).toBe('');
  expect(unmeasuredText(3, 3)).toContain('a guess');
  expect(unmeasuredText(1, 3)).toContain('1 of 3');
});

test('what an action typically takes is known by its number', () => {
  expect([...typicalOf(transition)]).toEqual([[1, 0.0005], [2, 0.00001], [3, 0.0002]]);
  expect(typicalOf({ actions: transition.actions }).size).toBe(0);
});

test('the summary has the numbers of the robot, with units', () => {
  const text = textOf(renderToStaticMarkup(createElement(PlanSummary, { transition })));
  expect(text).toContain('3 actions, 2 of them state changes; order seamless');
  expect(text).toContain('total 1 ms 2 ms 4 ms');
  expect(text).not.toContain('retire');
});

test('a property has its old and its new value', () => {
  expect(textOf(renderToStaticMarkup(createElement(Changes, { changes: transition.changes })))).toContain('&#x27;distance&#x27;: not set → 0.3');
});

test('actions have numbers, policies and durations, and the critical path is marked', () => {
  const items = phases().match(/<li.*?<\/li>/g)?.map(textOf) ?? [];
  expect(items[0]).toBe('· 1 configure seeker , waiting ◆ 500 µs');
  expect(items[1]).toBe('· 2 connect seeker.command -&gt; guard.command (circular_buffer of 4) , waiting 10 µs');
  expect(items[2]).toContain('3 start seeker');
});
