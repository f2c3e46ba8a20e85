// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Entry, Life, Mission, PlanNode } from './mission';
import { runOfMission } from './run';
import { waitsOf, withWaiting } from './waiting';

type After = [node: number, kind: string, because: string];

function node(name: string, after: After[] = [], units: PlanNode['units'] = [], role = 'irreversible'): PlanNode {
  return { name, in: '', role, units, after: after.map(([from, kind, because]) => ({ node: from, kind, subject: 'success', because, holds_start: true })) };
}

function waits(nodes: PlanNode[], events: [Entry['kind'], string][], state = 'running') {
  const entries = events.map(([kind, action], index) => ({ number: index + 1, time_s: index, kind, action, iteration: 0, ...(kind === 'ended' ? { outcome: 'success' } : {}) }));
  const mission: Mission = {
    run: 1, mission: 'fetch', who: 'a test', state, dropped: 0, plan: { mission: 'fetch', states: [], complete: true, nodes },
    entries: Object.fromEntries(entries.map((one) => [String(one.number), one])),
  };
  return Object.fromEntries(waitsOf(mission, runOfMission(mission)));
}

describe('a state that waits', () => {
  const chain = [
    node('get/look'), node('get/lift', [[0, 'data', 'data pose -> goal; condition success']]), node('get/hold', [[1, 'world', 'world held(box): made true there, relied on here']]),
    node('drive', [[0, 'resource', 'resource process:planner: what is irreversible uses it in the program\'s order']]),
  ];
  it('says for what, unless that waits, too', () => {
    expect(waits(chain, [['began', ''], ['began', 'get/look']])).toEqual({ 'get/lift': ['look (data pose -> goal and outcome success)'], drive: ['get/look (resource process:planner)'] });
    expect(waits(chain, [['began', ''], ['began', 'get/look'], ['ended', 'get/look'], ['began', 'get/lift'], ['began', 'drive']])).toEqual({ 'get/hold': ['lift (fact held(box))'] });
  });
  it('does not wait where nothing has begun, or the mission has ended', () => {
    expect(waits(chain, [['began', '']])).toEqual({});
    expect(waits(chain, [['began', ''], ['began', 'get/look'], ['ended', '']], 'ended')).toEqual({});
  });
  it('waits for units once nothing else is missing', () => {
    const both = [node('a'), node('b', [[0, 'condition', 'condition success']], [{ resource: 'arm', observed: false }, { resource: 'localized', observed: true }])];
    expect(waits(both, [['began', ''], ['began', 'a']])).toEqual({ b: ['a (outcome success)'] });
    expect(waits(both, [['began', ''], ['began', 'a'], ['ended', 'a']])).toEqual({ b: ['units of arm', 'units of localized, as the robot shows them'] });
    expect(waits(both, [['began', ''], ['began', 'a'], ['ended', 'a'], ['began', 'b']])).toEqual({});
    expect(waits(both, [['began', ''], ['began', 'a'], ['ended', 'a']], 'paused')).toEqual({});
  });
  it('waits for all that it comes after, also through joins and whatever that touches', () => {
    const joined = [node('a'), node('b'), node('join', [[0, 'condition', 'condition success'], [1, 'condition', 'condition success']], [], 'join'), node('c', [[2, 'opaque', 'opaque a: it may touch anything']])];
    expect(waits(joined, [['began', ''], ['began', 'a'], ['began', 'b']])['c']).toEqual(['a (outcome success)', 'b (outcome success)']);
    const opaque = [node('a'), node('c', [[0, 'opaque', 'opaque a: it declares no facts and no resources, so it may touch anything']])];
    expect(waits(opaque, [['began', ''], ['began', 'a']])).toEqual({ c: ['a (whatever it touches)'] });
  });
  it('is lit unless it runs', () => {
    const lives = new Map<string, Life>([['a', 'running'], ['b', 'done']]);
    const lit = withWaiting(lives, new Map(['a', 'b', 'c'].map((path) => [path, ['x']])));
    expect([...lit]).toEqual([['a', 'running'], ['b', 'waiting'], ['c', 'waiting']]);
  });
});
