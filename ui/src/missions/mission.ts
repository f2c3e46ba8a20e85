// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json } from '../robot/change';

/** The document "mission" (segue/control/robot_service.hpp, segue/draw/shown_plan.hpp). */
export interface PlanState {
  path: string;
  in?: string;
  title: string;
  kind: string;
  action?: string;
  library?: string;
  start?: string;
  next: { outcome: string; to?: string; returns?: string }[];
  flows?: { from: string; to: string; what: string }[];
  /** The units of the robot that it takes when it begins. */
  units?: { name: string; count: number }[];
}

export interface PlanNode {
  name: string;
  in: string;
  role: string;
  after: { node: number; kind: string; subject: string; because: string; holds_start: boolean }[];
  /** The resources of which it needs units to begin; `observed`: the robot shows how many there are. */
  units?: { resource: string; observed: boolean }[];
}

export interface Plan {
  mission: string;
  states: PlanState[];
  complete: boolean;
  nodes: PlanNode[] | null;
}

export interface Entry {
  number: number;
  time_s: number;
  kind: 'began' | 'asked' | 'ended';
  action: string;
  iteration: number;
  controller?: string;
  outcome?: string;
  error?: string;
}

export interface Mission {
  run: number;
  mission: string;
  who: string;
  state: string;
  outcome?: string;
  error?: string;
  dropped: number;
  plan: Plan | { problem: string } | null;
  entries: Record<string, Entry>;
  /** See controlOf(). */
  control?: Json;
}

/** Null where no mission has commanded the robot. */
export function missionOf(value: Json | undefined): Mission | null {
  return isMap(value) && isMap(value['entries']) ? (value as unknown as Mission) : null;
}

const isText = (value: Json | undefined): value is string => typeof value === 'string';

function isState(value: Json): boolean {
  if (!isMap(value)) return false;
  const { path, title, kind, next, flows, units } = value;
  if (units !== undefined && !(Array.isArray(units) && units.every((one) => isMap(one) && isText(one['name']) && typeof one['count'] === 'number'))) return false;
  const hasFlows = flows === undefined || (Array.isArray(flows) && flows.every((one) => isMap(one) && isText(one['from']) && isText(one['to']) && isText(one['what'])));
  return isText(path) && isText(title) && isText(kind) && Array.isArray(next) && next.every(isMap) && hasFlows;
}

function isNode(value: Json): boolean {
  if (!isMap(value) || !isText(value['name']) || !isText(value['role']) || !Array.isArray(value['after'])) return false;
  const { units } = value;
  if (units !== undefined && !(Array.isArray(units) && units.every((one) => isMap(one) && isText(one['resource'])))) return false;
  return value['after'].every((one) => isMap(one) && typeof one['node'] === 'number' && isText(one['kind']) && isText(one['because']));
}

function isPlan(plan: Json): boolean {
  if (!isMap(plan)) return false;
  const { states, nodes } = plan;
  return Array.isArray(states) && states.every(isState) && (nodes === null || (Array.isArray(nodes) && nodes.every(isNode)));
}

const checked = new WeakMap<object, boolean>();

/** The plan in the mission's report. The mission is another program, so a document with another structure is not a plan. */
export function planOf(mission: Mission): Plan | null {
  const { plan } = mission;
  if (typeof plan !== 'object' || plan === null) return null;
  const known = checked.get(plan) ?? isPlan(plan as unknown as Json);
  checked.set(plan, known);
  return known ? (plan as Plan) : null;
}

/** Why the plan is not shown. */
export function planProblem(mission: Mission): string {
  const plan = mission.plan as unknown as Json;
  if (isMap(plan)) return 'The plan cannot be shown: ' + (isText(plan['problem']) ? plan['problem'] : 'it is not as expected');
  return mission.state === 'ended' ? 'Nobody looked while it ran, so its plan is not known.' : 'Waiting for the plan …';
}

/** The entries in the order of events: keys of maps that look like numbers are sorted by JavaScript. */
export function entriesOf(mission: Mission): Entry[] {
  return Object.values(mission.entries);
}

/** The paths of states in which something has happened; the chart of a run shows what is in them. */
export function containersIn(entries: Entry[]): Set<string> {
  return new Set(entries.flatMap((entry) => pathsTo(entry.action).slice(0, -1)));
}

export type Life = 'idle' | 'running' | 'waiting' | 'next' | 'done' | 'failed';

function worse(outcome: string): boolean {
  return outcome === 'aborted' || outcome === 'preempted' || outcome === 'lost';
}

/** How states are called in boxes, panels and the legend. */
export const lifeWords: Record<Life, string> = { idle: 'has not begun', running: 'running', waiting: 'waits', next: 'next', done: 'has ended', failed: 'failed' };

/**
 * How each state is: a container runs from its begin to its end, and while something in it does or the mission is held in it, `at` states that come
 * next.
 * States that have not begun are left out.
 */
export function livesOf(mission: Mission, at: string[] = []): Map<string, Life> {
  const running = new Map<string, number>();
  const lives = new Map<string, Life>();
  const begun = new Set<string>();
  const entries = entriesOf(mission);
  const containers = containersIn(entries);
  for (const entry of entries) {
    if (entry.kind === 'asked') continue;
    const execution = entry.action + '#' + entry.iteration;
    // An action that may not begin has an end only.
    const change = entry.kind === 'began' ? 1 : begun.has(execution) ? -1 : 0;
    if (entry.kind === 'began') begun.add(execution);
    else begun.delete(execution);
    const paths = pathsTo(entry.action);
    for (const path of paths) {
      // An action that ran ahead in a container, and was not needed, has no end.
      const isOver = entry.kind === 'ended' && path === entry.action && containers.has(path);
      const count = isOver ? 0 : Math.max(0, (running.get(path) ?? 0) + change);
      running.set(path, count);
      if (count > 0) lives.set(path, 'running');
      else lives.set(path, path === entry.action && worse(entry.outcome ?? '') ? 'failed' : 'done');
    }
  }
  if (mission.state === 'ended') {
    for (const [path, life] of lives) {
      if (life === 'running') lives.set(path, worse(mission.outcome ?? '') ? 'failed' : 'done');
    }
  }
  for (const next of at) for (const path of pathsTo(next)) lives.set(path, path === next ? 'next' : 'running');
  return lives;
}

/** "a/b" -> "a", "a/b". The mission itself is the only one whose path is empty. */
export function pathsTo(path: string): string[] {
  const parts = path.split('/');
  return parts.map((_, index) => parts.slice(0, index + 1).join('/'));
}
