// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { livesOf, planProblem, type Entry, type Mission, type PlanNode } from './mission';
import { runOfFile, runOfMission } from './run';

let number = 0;
function entry(time_s: number, kind: Entry['kind'], action: string, outcome = '', iteration = 0): Entry {
  return { number: ++number, time_s, kind, action, iteration, ...(outcome === '' ? {} : { outcome }) };
}

function mission(state: string, entries: Entry[], nodes: PlanNode[] | null = null, outcome = ''): Mission {
  return {
    run: 1, mission: 'fetch', who: 'a test', state, outcome, dropped: 0,
    plan: { mission: 'fetch', states: [], complete: true, nodes },
    entries: Object.fromEntries(entries.map((one) => [String(one.number), one])),
  };
}

function node(name: string, after: [number, string, string][] = [], role = 'irreversible'): PlanNode {
  return { name, in: '', role, after: after.map(([from, kind, subject]) => ({ node: from, kind, subject, because: kind + ' ' + subject, holds_start: true })) };
}

describe('a mission that runs', () => {
  const plan = [node('look'), node('plan', [[0, 'data', 'pose']], 'pure'), node('lift', [[1, 'condition', 'success']]), node('stop', [[1, 'condition', 'failed']])];

  it('shows what runs and what waits for what', () => {
    const run = runOfMission(mission('running', [entry(10, 'began', ''), entry(10, 'began', 'look'), entry(12, 'ended', 'look', 'success'), entry(12.5, 'began', 'plan')], plan));
    expect(run.rows.map((row) => [row.label, row.status])).toEqual([['look', 'done'], ['plan', 'running'], ['lift', 'waiting'], ['stop', 'waiting']]);
    expect(run.rows[1]?.waits).toEqual([{ row: 0, kind: 'data', because: 'data pose', from: 0, until: 2 }]);
    expect(run.rows[2]?.waits[0]).toMatchObject({ row: 1, because: 'condition success', until: Infinity });
    expect(run.rows.filter((row) => row.critical).map((row) => row.label)).toEqual(['look', 'plan']);
    expect(run.ended).toBe(false);
  });
  it('leaves out ways that are not taken, and says what was thrown away', () => {
    const entries = [entry(0, 'began', ''), entry(0, 'began', 'look'), entry(0, 'began', 'stop'), entry(1, 'ended', 'look', 'success'), entry(1, 'began', 'plan'), entry(2, 'ended', 'plan', 'success')];
    const run = runOfMission(mission('running', entries, plan));
    expect(run.rows[3]).toMatchObject({ status: 'discarded', bars: [{ from: 0, until: 2, discarded: true }] });
    expect(run.rows[2]?.status).toBe('waiting');
  });
  it('says what ran ahead of its turn and counts', () => {
    const entries = [entry(0, 'began', ''), entry(0, 'began', 'look'), entry(0, 'began', 'plan'), entry(1, 'ended', 'plan', 'success'), entry(2, 'ended', 'look', 'success')];
    expect(runOfMission(mission('running', entries, plan)).rows.map((row) => row.ahead)).toEqual([false, true, false, false]);
  });
  it('does without a plan that is none', () => {
    for (const bad of ['here', 7, { states: 5 }, { states: [{ path: 1 }], nodes: null }, { states: [], nodes: [{ name: 'a', role: 'pure', after: [3] }] }]) {
      const strange = { ...mission('running', [entry(0, 'began', ''), entry(0, 'began', 'a')]), plan: bad } as unknown as Mission;
      expect(runOfMission(strange).rows).toHaveLength(1);
      expect(planProblem(strange)).not.toBe('');
    }
  });
  it('looks through what is not an action', () => {
    const joined = [node('a'), node('b'), node('join', [[0, 'condition', 'success'], [1, 'condition', 'success']], 'join'), node('c', [[2, 'condition', 'success']])];
    const run = runOfMission(mission('running', [entry(0, 'began', ''), entry(0, 'began', 'a')], joined));
    expect(run.rows.map((row) => row.label)).toEqual(['a', 'b', 'c']);
    expect(run.rows[2]?.waits.map((wait) => wait.row)).toEqual([0, 1]);
  });
  it('shows runs without a plan, and executions that are repeated', () => {
    const entries = [entry(0, 'began', ''), entry(0, 'began', 'a'), entry(1, 'ended', 'a', 'success'), entry(1, 'began', 'a', '', 1), entry(3, 'ended', 'a', 'aborted', 1), entry(3, 'ended', '', 'failed')];
    const run = runOfMission(mission('ended', entries));
    expect(run.rows.map((row) => [row.label, row.status, row.critical])).toEqual([['a', 'done', true], ['a#1', 'failed', true]]);
    expect(run).toMatchObject({ ended: true, until: 3 });
  });
  it('tells a mission that was killed from one that has ended', () => {
    const entries = [entry(0, 'began', ''), entry(0, 'began', 'look'), entry(4, 'ended', '', 'lost')];
    const killed = runOfMission(mission('ended', entries, plan, 'lost'));
    expect(killed.rows.map((row) => row.status)).toEqual(['lost', 'skipped', 'skipped', 'skipped']);
    expect(killed.rows[0]?.bars).toEqual([{ from: 0, until: 4, discarded: false }]);
    expect(runOfMission(mission('ended', entries, plan, 'done')).rows[0]?.status).toBe('discarded');
  });
});

describe('states', () => {
  it('run while something in them does', () => {
    const entries = [entry(0, 'began', 'a/x'), entry(0, 'began', 'a/y'), entry(1, 'ended', 'a/x', 'aborted'), entry(1, 'began', 'b')];
    expect([...livesOf(mission('running', entries))]).toEqual([['a', 'running'], ['a/x', 'failed'], ['a/y', 'running'], ['b', 'running']]);
    expect(livesOf(mission('ended', entries, null, 'lost')).get('b')).toBe('failed');
  });
  it('run between what is done in them, and end as they say', () => {
    const begun = [entry(0, 'began', 'a'), entry(0, 'began', 'a/x'), entry(0, 'began', 'a/ahead'), entry(1, 'ended', 'a/x', 'success')];
    expect(livesOf(mission('running', begun)).get('a')).toBe('running');
    expect(livesOf(mission('running', [...begun, entry(2, 'ended', 'a', 'aborted')])).get('a')).toBe('failed');
    expect(livesOf(mission('running', [...begun, entry(2, 'ended', 'a', 'success')])).get('a')).toBe('done');
    expect(livesOf(mission('running', [...begun, entry(2, 'ended', 'a', 'success'), entry(2, 'began', 'a', '', 1), entry(2, 'began', 'a/x', '', 1)])).get('a')).toBe('running');
  });
  it('are rows of the chart only where they are actions', () => {
    const entries = [entry(0, 'began', ''), entry(0, 'began', 'a'), entry(0, 'began', 'a/x'), entry(1, 'ended', 'a/x', 'success'), entry(1, 'ended', 'a', 'success')];
    expect(runOfMission(mission('running', entries)).rows.map((row) => row.label)).toEqual(['a/x']);
  });
});

describe('a recorded run', () => {
  it('is read', () => {
    const run = runOfFile(JSON.stringify({
      name: 'fetch', makespan_s: 3,
      nodes: [
        { name: 'a', iteration: 0, start_s: 0, end_s: 1, status: 'done', outcome: 'success', waited_for: [] },
        { name: 'a', iteration: 1, start_s: 1, end_s: 3, status: 'failed', outcome: 'aborted', error: 'no', waited_for: [{ kind: 'data', node: 'a', subject: 'pose', from_s: 0, until_s: 1 }] },
        { name: 'b', iteration: 0, start_s: 1, end_s: 2, status: 'skipped', waited_for: [] },
        { name: 'c', iteration: 0, start_s: 0, end_s: 0, status: 'skipped', waited_for: [] },
      ],
    }));
    expect(run.rows.map((row) => [row.label, row.status, row.critical])).toEqual([['a', 'done', true], ['a#1', 'failed', true], ['b', 'discarded', false], ['c', 'skipped', false]]);
    expect(run.rows[1]?.waits).toEqual([{ row: 0, kind: 'data', because: 'data pose', from: 0, until: 1 }]);
  });
  it('is refused where it is none', () => {
    expect(() => runOfFile('{')).toThrow(/not JSON/);
    expect(() => runOfFile('[]')).toThrow(/not a run/);
  });
});
