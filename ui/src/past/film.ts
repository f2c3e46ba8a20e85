// SPDX-License-Identifier: Apache-2.0
import { placeOf, titleOf } from '../network/graph';
import { isMap, type Json } from '../robot/change';
import { taskOf } from '../robot/types';

/** A network as the journal has it. */
export interface PastNetwork {
  tasks: { id: string; component: string; state: string; host: string; process: string }[];
  connections: { from: string; to: string }[];
}

export interface PastAction {
  id: number;
  kind: string;
  phase: string;
  label: string;
  started_s: number;
  duration_s: number;
  /** Since the begin of the transition, as started_s; older journals have none. */
  ended_s?: number;
  outcome: string;
  error?: string;
  host: string;
  process: string;
}

export interface PastTransition {
  id: number;
  from: string;
  to: string;
  runs: string;
  outcome: string;
  undone?: string;
  error?: string;
  who: string;
  cancelled_by?: string;
  ended_s: number;
  lasted_s: number | null;
  actions: PastAction[];
  undo_actions: PastAction[];
  before: string | null;
  after: string | null;
}

export interface PastRequest {
  id: number;
  ended_s: number;
  lasted_s: number | null;
  cause: string;
  who: string;
  cancelled_by: string;
  from: string;
  to: string;
  outcome: string;
  undone: string;
  error: string;
  actions: number;
}

/** Null where it was not recorded, or is not a network. */
export function networkOf(text: string | null): PastNetwork | null {
  if (text === null) return null;
  try {
    const value = JSON.parse(text) as Json;
    return isMap(value) && Array.isArray(value['tasks']) && Array.isArray(value['connections']) ? (value as unknown as PastNetwork) : null;
  } catch {
    return null;
  }
}

/** "connect a.out -> b.in (data)" -> ["a.out", "b.in"]. */
export function endsOf(label: string): [string, string] | null {
  const found = /^(?:dis)?connect (\S+) -> (\S+)/.exec(label);
  return found ? [found[1] ?? '', found[2] ?? ''] : null;
}

const ofTasks = new Set(['recover', 'stop', 'cleanup', 'configure', 'start']);

/** The task that an action acts on. */
export function taskOfAction(action: PastAction): string | null {
  return ofTasks.has(action.kind) ? (action.label.slice(action.kind.length + 1).split(' ')[0] ?? null) : null;
}

export function endOf(action: PastAction): number {
  return action.ended_s ?? action.started_s + action.duration_s;
}

export interface Film {
  transition: PastTransition;
  before: PastNetwork | null;
  after: PastNetwork | null;
  /** All that was carried out, undoing included, in the order in which it ended. */
  steps: PastAction[];
  length: number;
}

export function filmOf(transition: PastTransition): Film {
  const steps = [...transition.actions, ...transition.undo_actions].filter((action) => action.outcome !== 'skipped').sort((a, b) => endOf(a) - endOf(b));
  const last = steps.reduce((most, action) => Math.max(most, endOf(action)), 0);
  return { transition, before: networkOf(transition.before), after: networkOf(transition.after), steps, length: Math.max(last, transition.lasted_s ?? 0) };
}

/** From when to when a phase of a transition was carried out. */
export interface PhaseSpan {
  /** "prepare", "commit", "retire", "undo". */
  phase: string;
  from: number;
  to: number;
}

/** The phases in which something was done. */
export function phasesOf({ steps, transition }: Film): PhaseSpan[] {
  const spans = new Map<string, PhaseSpan>();
  for (const action of steps) {
    const phase = transition.undo_actions.includes(action) ? 'undo' : action.phase;
    const { from, to } = spans.get(phase) ?? { from: Infinity, to: 0 };
    spans.set(phase, { phase, from: Math.min(from, action.started_s), to: Math.max(to, endOf(action)) });
  }
  return [...spans.values()].sort((a, b) => a.from - b.from);
}

/** The state of an action at a time of the film. */
export type Moment = 'waiting' | 'running' | 'done' | 'failed' | 'skipped';

export function momentOf(action: PastAction, at: number): Moment {
  if (action.outcome === 'skipped') return 'skipped';
  if (at < action.started_s) return 'waiting';
  if (at < endOf(action)) return 'running';
  return action.outcome === 'done' ? 'done' : 'failed';
}

export type Presence = 'there' | 'not yet' | 'gone';

export interface FrameTask {
  id: string;
  place: string;
  fate: 'unchanged' | 'removed' | 'added' | 'changed';
  presence: Presence;
  state: string;
}

export interface FrameEdge {
  id: string;
  source: string;
  target: string;
  fate: 'unchanged' | 'removed' | 'added' | 'changed';
  presence: Presence;
}

export interface Frame {
  tasks: FrameTask[];
  edges: FrameEdge[];
}

const statesAfter: Record<string, string> = { configure: 'stopped', start: 'running', stop: 'stopped', cleanup: 'pre_operational' };

function placeIn(network: PastNetwork | null, id: string): string | undefined {
  const task = network?.tasks.find((one) => one.id === id);
  return task && placeOf(task);
}

/** The boxes around the tasks of a frame, as in the view Network. */
export function groupsOf(frame: Frame): { id: string; title: string }[] {
  return [...new Set(frame.tasks.map((task) => task.place))].sort().map((place) => ({ id: 'group:' + place, title: titleOf(place) }));
}

/** The frame of a network that does not change. */
export function frameOfNetwork(network: PastNetwork): Frame {
  const edges = new Map<string, FrameEdge>();
  for (const { from, to } of network.connections) {
    const [source, target] = [taskOf(from), taskOf(to)];
    edges.set(source + ' -> ' + target, { id: source + ' -> ' + target, source, target, fate: 'unchanged', presence: 'there' });
  }
  return {
    tasks: network.tasks.map((task) => ({ id: task.id, place: placeOf(task), fate: 'unchanged', presence: 'there', state: task.state })),
    edges: [...edges.values()],
  };
}

/**
 * Both networks of a transition as they were at a time of it: what its actions had made true by then. Where the network of before
 * was not recorded, only what actions name is drawn.
 */
export function frameOf(film: Film, at: number): Frame {
  const before = new Map(film.before?.tasks.map((task) => [task.id, task]) ?? []);
  const after = new Map(film.after?.tasks.map((task) => [task.id, task]) ?? []);
  const ended = film.steps.filter((action) => action.outcome === 'done' && endOf(action) <= at);
  const isOver = at >= film.length && film.after !== null;
  const touched = new Map<string, PastAction[]>();
  for (const action of film.steps) {
    const id = taskOfAction(action);
    if (id !== null) touched.set(id, [...(touched.get(id) ?? []), action]);
  }

  const tasks: FrameTask[] = [];
  for (const id of new Set([...before.keys(), ...touched.keys(), ...after.keys()])) {
    const done = (touched.get(id) ?? []).filter((action) => ended.includes(action));
    const goes = before.has(id) && film.after !== null && !after.has(id);
    const comes = !before.has(id) && film.before !== null;
    const last = done[done.length - 1];
    const there = isOver ? after.has(id) : comes ? done.length > 0 && !(after.has(id) === false && last?.kind === 'cleanup') : !(goes && last?.kind === 'cleanup');
    const state = isOver ? after.get(id)?.state : done.reduce<string | undefined>((now, action) => statesAfter[action.kind] ?? now, before.get(id)?.state);
    tasks.push({
      id,
      place: placeIn(film.before, id) ?? placeIn(film.after, id) ?? '',
      fate: goes ? 'removed' : comes ? 'added' : touched.has(id) ? 'changed' : 'unchanged',
      presence: there ? 'there' : comes && done.length === 0 && !isOver ? 'not yet' : 'gone',
      state: state ?? 'not known',
    });
  }
  return { tasks, edges: edgesOf(film, ended, isOver) };
}

/** Connections between the same two tasks are one edge. */
function edgesOf(film: Film, ended: PastAction[], isOver: boolean): FrameEdge[] {
  const now = new Set(film.before?.connections.map(({ from, to }) => from + ' -> ' + to) ?? []);
  const all = new Map<string, { first: boolean; acts: boolean }>();
  for (const one of now) all.set(one, { first: true, acts: false });
  for (const action of film.steps) {
    const ends = endsOf(action.label);
    if (!ends) continue;
    const one = ends.join(' -> ');
    all.set(one, { first: all.get(one)?.first ?? (film.before === null && action.kind === 'disconnect'), acts: true });
    if (!ended.includes(action)) continue;
    if (action.kind === 'connect') now.add(one);
    else now.delete(one);
  }
  const atEnd = film.after && new Set(film.after.connections.map(({ from, to }) => from + ' -> ' + to));
  for (const one of atEnd ?? []) if (!all.has(one)) all.set(one, { first: false, acts: false });
  const there = isOver && atEnd ? atEnd : now;
  const edges = new Map<string, FrameEdge>();
  for (const [one, { first, acts }] of all) {
    const [from, to] = one.split(' -> ') as [string, string];
    const id = taskOf(from) + ' -> ' + taskOf(to);
    const fate = !first ? 'added' : !acts ? 'unchanged' : (atEnd?.has(one) ?? false) ? 'changed' : 'removed';
    const presence: Presence = there.has(one) ? 'there' : first ? 'gone' : 'not yet';
    const known = edges.get(id);
    edges.set(id, {
      id, source: taskOf(from), target: taskOf(to),
      fate: !known || known.fate === fate ? fate : 'changed',
      presence: known?.presence === 'there' ? 'there' : presence,
    });
  }
  return [...edges.values()];
}
