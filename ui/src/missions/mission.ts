// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json } from '../robot/change';

/** What the document "mission" looks like (segue/control/robot_service.hpp, segue/draw/shown_plan.hpp). */
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
}

export interface PlanNode {
  name: string;
  in: string;
  role: string;
  after: { node: number; kind: string; subject: string; because: string; holds_start: boolean }[];
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
}

/** Null where no mission has commanded the robot. */
export function missionOf(value: Json | undefined): Mission | null {
  return isMap(value) && isMap(value['entries']) ? (value as unknown as Mission) : null;
}

export function planOf(mission: Mission): Plan | null {
  return mission.plan && 'states' in mission.plan ? mission.plan : null;
}

/** What happened, in its order: keys of maps that look like numbers are sorted by JavaScript. */
export function entriesOf(mission: Mission): Entry[] {
  return Object.values(mission.entries);
}

export type Life = 'idle' | 'running' | 'done' | 'failed';

function worse(outcome: string): boolean {
  return outcome === 'aborted' || outcome === 'preempted' || outcome === 'lost';
}

/** How each state is: a container runs while something in it does. States that have not begun are left out. */
export function livesOf(mission: Mission): Map<string, Life> {
  const running = new Map<string, number>();
  const lives = new Map<string, Life>();
  for (const entry of entriesOf(mission)) {
    if (entry.kind === 'asked') continue;
    const change = entry.kind === 'began' ? 1 : -1;
    const paths = pathsTo(entry.action);
    for (const path of paths) {
      const count = Math.max(0, (running.get(path) ?? 0) + change);
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
  return lives;
}

/** "a/b" -> "a", "a/b". The mission itself is the only one whose path is empty. */
export function pathsTo(path: string): string[] {
  const parts = path.split('/');
  return parts.map((_, index) => parts.slice(0, index + 1).join('/'));
}
