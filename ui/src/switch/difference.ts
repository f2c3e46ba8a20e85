// SPDX-License-Identifier: Apache-2.0
import { placeOf } from '../network/graph';
import { taskOf, type Action, type RobotEvent, type Status, type Transition } from '../robot/types';

export type Fate = 'unchanged' | 'removed' | 'added' | 'changed';

export interface Difference {
  tasks: { id: string; fate: Fate; place: string }[];
  edges: { id: string; source: string; target: string; fate: Fate }[];
}

/** The changes of a transition to the network that runs, as one graph of both networks. */
export function differenceOf(status: Status, transition: Transition): Difference {
  const touched = new Set(transition.actions.flatMap((action) => (action.task ? [action.task] : [])));
  const removed = new Set(transition.removes ?? []);
  const tasks: Difference['tasks'] = Object.values(status.tasks).map((task) => ({
    id: task.id,
    place: placeOf(task),
    fate: removed.has(task.id) ? 'removed' : touched.has(task.id) ? 'changed' : 'unchanged',
  }));
  for (const id of touched) {
    if (!status.tasks[id]) tasks.push({ id, place: '', fate: 'added' });
  }

  const edges = new Map<string, Difference['edges'][number]>();
  for (const connection of Object.values(status.connections)) {
    const [source, target] = [taskOf(connection.from), taskOf(connection.to)];
    const id = source + ' -> ' + target;
    edges.set(id, { id, source, target, fate: 'unchanged' });
  }
  const ends = (action: Action) => [taskOf(action.from ?? ''), taskOf(action.to ?? '')] as const;
  for (const action of transition.actions) {
    if ((action.kind !== 'connect' && action.kind !== 'disconnect') || !action.from || !action.to) continue;
    const [source, target] = ends(action);
    const id = source + ' -> ' + target;
    const known = edges.get(id);
    const fate: Fate = action.kind === 'connect' ? 'added' : 'removed';
    // Several connections between two tasks are one edge: one that comes and one that goes is a change.
    edges.set(id, { id, source, target, fate: !known || (known.fate === 'unchanged' && fate === 'removed') ? fate : known.fate === fate ? fate : 'changed' });
  }
  return { tasks, edges: [...edges.values()] };
}

/** How events name an action; they may say more behind it, such as the policy of a connection. */
export function subjectOf(action: Action): string {
  if (action.from && action.to) return action.kind + ' ' + action.from + ' -> ' + action.to;
  if (action.task && action.operation) return action.kind + ' ' + action.task + '.' + action.operation;
  return action.kind + ' ' + (action.task ?? [action.host, action.process].filter(Boolean).join('/'));
}

export type Progress = 'waiting' | 'done' | 'failed';

/** The progress of each action by the events after the request; the undoing of an action does not count. */
export function progressOf(actions: Action[], events: RobotEvent[], after: number): Map<number, Progress> {
  const told = new Map<string, Progress>();
  for (const event of events) {
    if (event.number <= after) continue;
    if (event.kind === 'transition_undone') break;
    if (event.kind === 'action_done') told.set(event.subject, 'done');
    if (event.kind === 'action_failed') told.set(event.subject, 'failed');
  }
  const found = (subject: string) =>
    told.get(subject) ?? [...told].find(([said]) => said.startsWith(subject + ' '))?.[1] ?? 'waiting';
  return new Map(actions.map((action) => [action.id, found(subjectOf(action))]));
}

export interface Estimate {
  /** Seconds, along the longest chain of actions that wait for each other. */
  seconds: number;
  /** The actions of that chain. */
  critical: Set<number>;
  /** How many of the actions were measured before, themselves or others of their kind. */
  known: number;
}

function median(values: number[]): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)] ?? 0;
}

/** Estimates the time of a switch from how long these actions, or others of their kind, took in past transitions. */
export function estimateOf(actions: Action[], history: Transition[]): Estimate {
  const times = new Map<string, number[]>();
  const note = (key: string, seconds: number) => times.set(key, [...(times.get(key) ?? []), seconds]);
  for (const action of history.flatMap((past) => past.actions)) {
    const took = action.took_s ?? action.duration_s;
    if (took === undefined || action.outcome !== 'done') continue;
    note(subjectOf(action), took);
    note(action.kind, took);
  }
  const ends = new Map<number, { at: number; before: number | null }>();
  const byId = new Map(actions.map((action) => [action.id, action]));
  const ended = (id: number): number => {
    const known = ends.get(id);
    if (known) return known.at;
    const action = byId.get(id);
    if (!action) return 0;
    ends.set(id, { at: 0, before: null }); // so that actions which wait for each other end, too
    let at = 0;
    let before: number | null = null;
    for (const earlier of action.after) {
      const end = ended(earlier);
      if (before === null || end > at) [at, before] = [end, earlier];
    }
    at += median(times.get(subjectOf(action)) ?? times.get(action.kind) ?? [0]);
    ends.set(id, { at, before });
    return at;
  };
  let last: number | null = null;
  for (const action of actions) {
    if (last === null || ended(action.id) > ended(last)) last = action.id;
  }
  const critical = new Set<number>();
  for (let at = last; at !== null && byId.has(at) && !critical.has(at); at = ends.get(at)?.before ?? null) critical.add(at);
  const known = actions.filter((action) => times.has(subjectOf(action)) || times.has(action.kind)).length;
  return { seconds: last === null ? 0 : ended(last), critical, known };
}
