// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { ConnectionStatus, Status, TaskStatus } from '../robot/types';
import { edgesOf, groupsOf, matching, rateOf, structureOf, toneOf } from './graph';

function task(id: string, more: Partial<TaskStatus> = {}): TaskStatus {
  return {
    id, component: 'demo::' + id, state: 'running', state_name: 'running', host: '', process: '', pid: 1,
    cycle_us: 1, worst_us: 1, cycles: 1, missed: 0, error: '', ...more,
  };
}
function connection(from: string, to: string, written = 0): ConnectionStatus {
  return { from, to, policy: 'data', size: 1, written, read: 0, dropped: 0 };
}
function status(tasks: TaskStatus[], connections: ConnectionStatus[] = []): Status {
  return {
    robot: 'r', controller: 'c', state: 'idle', commanded_by: null, controllers: [], ready: [],
    tasks: Object.fromEntries(tasks.map((one) => [one.id, one])),
    connections: Object.fromEntries(connections.map((one) => [one.from + ' ' + one.to, one])),
    differences: [], uptime_s: 1,
  };
}

describe('the network', () => {
  it('groups tasks by host and process', () => {
    const groups = groupsOf(status([task('b'), task('a'), task('c', { host: 'arm', process: 'p' })]));
    expect(groups.map((group) => [group.title, group.tasks.map((one) => one.id)])).toEqual([
      ['runtime', ['a', 'b']],
      ['arm / p', ['c']],
    ]);
  });
  it('joins connections between the same tasks', () => {
    const edges = edgesOf(status([], [connection('a.b.x', 'c.y'), connection('a.b.z', 'c.w')]));
    expect(edges).toHaveLength(1);
    expect(edges[0]).toMatchObject({ source: 'a.b', target: 'c' });
    expect(edges[0]?.connections).toHaveLength(2);
  });
  it('is laid out anew for another structure only', () => {
    const one = status([task('a')], [connection('a.x', 'a.y', 1)]);
    expect(structureOf(one)).toBe(structureOf(status([task('a', { state: 'stopped' })], [connection('a.x', 'a.y', 9)])));
    expect(structureOf(one)).not.toBe(structureOf(status([task('a', { process: 'p' })], [connection('a.x', 'a.y')])));
  });
  it('knows rates', () => {
    expect(rateOf(connection('a.x', 'b.y', 10), connection('a.x', 'b.y', 30), 2)).toBe(10);
    expect(rateOf(connection('a.x', 'b.y', 30), connection('a.x', 'b.y', 10), 2)).toBeNull();
    expect(rateOf(undefined, connection('a.x', 'b.y', 10), 2)).toBeNull();
    expect(rateOf(connection('a.x', 'b.y', 1), connection('a.x', 'b.y', 1), 0)).toBeNull();
  });
  it('finds tasks by words and colours states', () => {
    expect(matching(status([task('drive'), task('laser', { state: 'exception' })]), 'EXC las')).toEqual(['laser']);
    expect([toneOf('running'), toneOf('exception'), toneOf('stopped')]).toEqual(['good', 'bad', 'idle']);
  });
});
