// SPDX-License-Identifier: Apache-2.0
import { useCallback, useEffect, useState } from 'react';
import { reason } from '../reason';
import type { Json } from '../robot/change';
import { useConnection } from '../robot/hooks';
import type { Entry, Mission } from './mission';
import { runOfMission, type Run } from './run';

/** A run of a mission as the robot's journal has it ("missions" of segue/journal/past.hpp). */
export interface PastRun {
  id: number;
  mission: string;
  who: string;
  mode: string;
  began_s: number;
  ended_s: number | null;
  outcome: string;
  error: string;
}

/** How a run ended: its outcome; nothing is recorded of the end of one that runs, or whose runtime was killed. */
export function endOf(run: PastRun, runs: boolean): { text: string; tone: 'good' | 'idle' | 'bad' } {
  if (run.ended_s === null) return runs ? { text: 'running', tone: 'good' } : { text: 'no end recorded', tone: 'bad' };
  return { text: run.outcome === 'lost' ? 'killed or lost' : run.outcome, tone: run.outcome === 'aborted' || run.outcome === 'lost' ? 'bad' : run.outcome === 'preempted' ? 'idle' : 'good' };
}

/** "0.42 s", "12 s", "3 min 5 s", "2 h 10 min" */
export function lastedText(seconds: number): string {
  if (seconds < 10) return seconds.toFixed(2) + ' s';
  const whole = Math.round(seconds);
  if (whole < 60) return whole + ' s';
  if (whole < 3600) return Math.floor(whole / 60) + ' min ' + (whole % 60) + ' s';
  return Math.floor(whole / 3600) + ' h ' + Math.floor((whole % 3600) / 60) + ' min';
}

/** The chart of a past run. */
export function chartOf(past: PastRun & { entries: Entry[]; dropped: number }): Run {
  const { id, mission, who, error, dropped } = past;
  const whole: Mission = { run: id, mission, who, state: 'ended', outcome: past.ended_s === null ? 'lost' : past.outcome, error, dropped, plan: null, entries: past.entries as unknown as Record<string, Entry> };
  return runOfMission(whole);
}

const page = 50;

interface Page {
  missions: PastRun[];
  more: boolean;
}

/** The newest runs first, and older ones as they are asked for. Asked anew where `changed` does, and a second later: the journal is written behind. */
export function usePastRuns(changed: string) {
  const connection = useConnection();
  const [{ missions, more }, setShown] = useState<Page>({ missions: [], more: false });
  const [problem, setProblem] = useState('');
  const ask = useCallback(async (question: { [key: string]: Json }) => (await connection.call('past', { ask: 'missions', limit: page, ...question })) as unknown as Page, [connection]);
  useEffect(() => {
    let current = true;
    const look = () => ask({}).then(
      (answer) => current && [setShown(answer), setProblem('')],
      (error: unknown) => current && setProblem(reason(error)),
    );
    void look();
    const later = setTimeout(() => void look(), 1000);
    return () => {
      current = false;
      clearTimeout(later);
    };
  }, [ask, changed]);
  const older = () => {
    const last = missions[missions.length - 1];
    if (!last) return;
    ask({ before: last.id }).then(
      (answer) => setShown((before) => ({ missions: [...before.missions, ...answer.missions.filter((one) => one.id < last.id)], more: answer.more })),
      (error: unknown) => setProblem(reason(error)),
    );
  };
  const open = async (id: number) => chartOf((await connection.call('past', { ask: 'mission', id })) as unknown as Parameters<typeof chartOf>[0]);
  return { missions, more, older, open, problem };
}
