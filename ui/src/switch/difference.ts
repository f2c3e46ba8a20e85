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
