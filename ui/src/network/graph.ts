// SPDX-License-Identifier: Apache-2.0
import { taskOf, type ConnectionStatus, type Status, type TaskStatus } from '../robot/types';

export interface Group {
  id: string;
  title: string;
  tasks: TaskStatus[];
}

/** "host / process", as far as there is one. */
export function placeOf(task: TaskStatus): string {
  return [task.host, task.process].filter((part) => part !== '').join(' / ');
}

/** Tasks by process and host, each sorted; the first group is the runtime's own process. */
export function groupsOf(status: Status): Group[] {
  const groups = new Map<string, TaskStatus[]>();
  for (const task of Object.values(status.tasks)) {
    const place = placeOf(task);
    groups.set(place, [...(groups.get(place) ?? []), task]);
  }
  return [...groups.entries()]
    .sort(([a], [b]) => a.localeCompare(b))
    .map(([place, tasks]) => ({
      id: 'group:' + place,
      title: place === '' ? 'runtime' : place,
      tasks: tasks.sort((a, b) => a.id.localeCompare(b.id)),
    }));
}

export type Tone = 'good' | 'idle' | 'bad' | 'warn';

/** How a state of the life cycle is coloured; its name always stands beside. */
export function toneOf(state: string): Tone {
  if (state === 'running') return 'good';
  if (state === 'exception' || state === 'fatal') return 'bad';
  if (state === 'runtime_error' || state === 'error') return 'warn';
  return 'idle';
}

/** What has to be laid out anew: changes when tasks, their places or connections change, not with values. */
export function structureOf(status: Status): string {
  const tasks = Object.values(status.tasks).map((task) => task.id + '@' + placeOf(task));
  return [...tasks, ...Object.keys(status.connections)].sort().join('\n');
}

/** Connections between the same two tasks are one edge. */
export function edgesOf(status: Status): { id: string; source: string; target: string; connections: string[] }[] {
  const edges = new Map<string, { id: string; source: string; target: string; connections: string[] }>();
  for (const [key, connection] of Object.entries(status.connections)) {
    const source = taskOf(connection.from);
    const target = taskOf(connection.to);
    const id = source + ' -> ' + target;
    const edge = edges.get(id) ?? { id, source, target, connections: [] };
    edge.connections.push(key);
    edges.set(id, edge);
  }
  return [...edges.values()];
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
