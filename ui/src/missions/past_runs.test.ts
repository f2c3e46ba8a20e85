// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Entry } from './mission';
import { chartOf, endOf, lastedText, type PastRun } from './past_runs';

function past(more: Partial<PastRun> = {}): PastRun {
  return { id: 7, mission: 'fetch', who: 'ann', mode: 'concurrent', began_s: 100, ended_s: 104, outcome: 'done', error: '', ...more };
}
const entry = (number: number, time_s: number, kind: Entry['kind'], action: string, outcome?: string): Entry => ({ number, time_s, kind, action, iteration: 0, outcome });

describe('a past run', () => {
  it('says how it ended', () => {
    expect(endOf(past(), false)).toEqual({ text: 'done', tone: 'good' });
    expect(endOf(past({ outcome: 'aborted' }), false).tone).toBe('bad');
    expect(endOf(past({ outcome: 'preempted' }), false).tone).toBe('idle');
    expect(endOf(past({ outcome: 'lost' }), false)).toEqual({ text: 'killed or lost', tone: 'bad' });
    expect(endOf(past({ ended_s: null, outcome: '' }), true).text).toBe('running');
    expect(endOf(past({ ended_s: null, outcome: '' }), false)).toEqual({ text: 'no end recorded', tone: 'bad' });
  });

  it('says how long it took', () => {
    expect([0.4211, 12.3, 185, 7805].map(lastedText)).toEqual(['0.42 s', '12 s', '3 min 5 s', '2 h 10 min']);
  });

  it('is drawn from what the journal has', () => {
    const entries = [entry(7, 100, 'began', ''), entry(8, 101, 'began', 'look'), entry(9, 103, 'ended', 'look', 'success'), entry(10, 103, 'began', 'grasp')];
    const run = chartOf({ ...past({ ended_s: null, outcome: '' }), entries, dropped: 0 });
    expect(run).toMatchObject({ name: 'fetch', began: 100, ended: true });
    expect(run.rows.map((row) => [row.label, row.status])).toEqual([['look', 'done'], ['grasp', 'lost']]);
    expect(run.rows[0]?.bars).toEqual([{ from: 1, until: 3, discarded: false }]);
  });
});
