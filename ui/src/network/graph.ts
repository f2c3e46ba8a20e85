// SPDX-License-Identifier: Apache-2.0
import type { ConnectionStatus, Status, TaskStatus } from '../robot/types';

/** "host / process", as far as there is one. */
export function placeOf(task: TaskStatus): string {
  return [task.host, task.process].filter((part) => part !== '').join(' / ');
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
