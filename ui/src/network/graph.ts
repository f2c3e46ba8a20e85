// SPDX-License-Identifier: Apache-2.0
import type { ConnectionStatus, Status, TaskStatus } from '../robot/types';

/** "host / process", as far as there is one. */
export function placeOf(task: Pick<TaskStatus, 'host' | 'process'>): string {
  return [task.host, task.process].filter((part) => part !== '').join(' / ');
}

/** The title of a box around the tasks of a place: the command line does not name the robot's own computer either. */
export function titleOf(place: string): string {
  return place === '' ? 'runtime' : place.replace(/^localhost \/ /, '');
}

export type Tone = 'good' | 'idle' | 'bad' | 'warn';

/** How a state of the life cycle is coloured; its name always stands beside. */
export function toneOf(state: string): Tone {
  if (state === 'running') return 'good';
  if (state === 'exception' || state === 'fatal') return 'bad';
  if (state === 'runtime_error' || state === 'error') return 'warn';
  return 'idle';
}

/** Samples written per second between two statuses; null where that cannot be known. */
export function rateOf(before: ConnectionStatus | undefined, now: ConnectionStatus, seconds: number): number | null {
  if (!before || !(seconds > 0) || now.written < before.written) return null;
  return (now.written - before.written) / seconds;
}

/** The recent flow through a connection. */
export interface Flow {
  /** Samples per second; null: not known. */
  rate: number | null;
  /** In microseconds; null: not known. */
  latency: number | null;
}
export type Flows = ReadonlyMap<string, Flow>;

/** "" for none. */
export function rateText(rate: number): string {
  return rate > 0 ? (rate < 10 ? rate.toFixed(1) : rate.toFixed(0)) + '/s' : '';
}

/** The mean latency of samples that were read between two statuses; where none was, of all so far. Null: not known. */
export function latencyOf(before: ConnectionStatus | undefined, now: ConnectionStatus): number | null {
  const measured = now.measured ?? 0;
  const mean = now.latency_us ?? 0;
  if (measured === 0) return null;
  const fresh = measured - (before?.measured ?? 0);
  if (!before || fresh <= 0 || fresh === measured) return mean;
  return Math.max(0, (measured * mean - (before.measured ?? 0) * (before.latency_us ?? 0)) / fresh);
}

/** Tasks whose id, component or state has all the words. */
export function matching(status: Status, words: string): string[] {
  const wanted = words.toLowerCase().split(/\s+/).filter((word) => word !== '');
  return Object.values(status.tasks)
    .filter((task) => {
      const text = [task.id, task.component, task.state, task.state_name].join(' ').toLowerCase();
      return wanted.every((word) => text.includes(word));
    })
    .map((task) => task.id)
    .sort();
}
