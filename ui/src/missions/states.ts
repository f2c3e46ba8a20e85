// SPDX-License-Identifier: Apache-2.0
import type { BoxMark } from '../network/BoxButtons';
import type { GraphEdge, GraphGroup, GraphNode } from '../network/drawn_graph';
import { fewestSeen } from '../network/folding';
import { lifeWords, pathsTo, type Life, type Plan, type PlanState } from './mission';

/** A plan with more states shows only its outermost ones open at first. */
const mostOpen = 40;

export interface StateGraph {
  groups: GraphGroup[];
  nodes: GraphNode[];
  edges: GraphEdge[];
}

export const idOf = (path: string): string => 'state:' + path;
export const pathOf = (id: string): string => id.slice('state:'.length);

const wordOf = (life: Life): string => (life === 'idle' ? '' : lifeWords[life]);

export function isContainer(state: PlanState): boolean {
  return ['hierarchy', 'barrier', 'preemptive'].includes(state.kind);
}

/**
 * Which containers are open at first: all, or as many of the outermost as can be seen; where not all of that can be read,
 * those of the next level, without the innermost ones of the level before.
 */
export function openLevels(plan: Plan): Set<string>[] {
  const most = new Set<string>();
  let shown = 0;
  for (const state of plan.states) {
    ++shown;
    if (state.path !== '' && isContainer(state) && shown <= mostOpen) most.add(state.path);
  }
  const depths = [...new Set([...most].map((path) => pathsTo(path).length))].sort((a, b) => b - a);
  const levels = [most, ...depths.map((depth) => new Set([...most].filter((path) => pathsTo(path).length < depth)))];
  const boxes = (open: Set<string>) => plan.states.filter((state) => state.path !== '' && visibleFor(state.path, open) === state.path && !open.has(state.path)).length;
  return levels.filter((level, index) => index === 0 || (level.size < (levels[index - 1]?.size ?? 0) && boxes(level) >= fewestSeen));
}

/** Which containers are around states, so that those can be seen. */
export function openFor(paths: string[]): string[] {
  return paths.flatMap((path) => pathsTo(path).slice(0, -1));
}

/** The innermost states around `path` that can be seen. */
function visibleFor(path: string, open: Set<string>): string {
  for (const outer of pathsTo(path)) {
    if (outer !== path && !open.has(outer)) return outer;
  }
  return path;
}

/** The states that are followed: before which the mission is held, or else that run. */
export function followedOf(plan: Plan, at: string[], lives: Map<string, Life>): string[] {
  return at.length > 0 ? at : plan.states.filter((state) => !isContainer(state) && lives.get(state.path) === 'running').map((state) => state.path);
}

/** Breakpoints as they are drawn; null: the mission cannot have any. */
export interface Breaks {
  at: string[];
  /** The breakpoints can only be looked at. */
  fixed: boolean;
}

function markOf(path: string, breaks: Breaks | null): BoxMark | undefined {
  return breaks && path !== '' ? { on: breaks.at.includes(path), label: 'Breakpoint at ' + path, fixed: breaks.fixed } : undefined;
}

const countText = (count: number) => count + (count === 1 ? ' state' : ' states');

function detailOf(state: PlanState, life: Life, waits: string[] | undefined, breaks: Breaks | null, inside: number): string {
  const returns = state.next.filter((one) => one.returns !== undefined).map((one) => (one.outcome === one.returns ? '↩ ' + one.returns : one.outcome + ' ↩ ' + one.returns));
  const marked = isContainer(state) && breaks?.at.some((path) => path.startsWith(state.path + '/')) ? '● inside' : '';
  if (waits) return ['waits for ' + waits.join('; '), marked].filter((part) => part !== '').join(' · ');
  return [wordOf(life), isContainer(state) ? state.kind + ', ' + countText(inside) : '', marked, ...returns].filter((part) => part !== '').join(' · ') || state.action || state.kind;
}

/** The run, as the boxes of states show it. */
export interface Progress {
  lives: Map<string, Life>;
  /** For what states wait. */
  waits: Map<string, string[]>;
}

/** The states that can be seen, in their open containers, with transitions and, if wanted, data flows between them. */
export function stateGraphOf(plan: Plan, { lives, waits }: Progress, open: Set<string>, withFlows: boolean, breaks: Breaks | null = null): StateGraph {
  const root = plan.states[0];
  const graph: StateGraph = { groups: [], nodes: [], edges: [] };
  const states = root && !isContainer(root) ? [root] : plan.states.filter((state) => state.path !== '' && visibleFor(state.path, open) === state.path);
  const starts = new Set(plan.states.map((state) => state.start));
  const inside = new Map<string, number>();
  for (const state of plan.states) for (const outer of pathsTo(state.path).slice(0, -1)) inside.set(outer, (inside.get(outer) ?? 0) + 1);
  for (const state of states) {
    const life = lives.get(state.path) ?? 'idle';
    const title = (starts.has(state.path) ? '▶ ' : '') + (state.title || plan.mission);
    const box = { id: idOf(state.path), group: state.in ? idOf(state.in) : undefined, look: 'life-' + life, first: starts.has(state.path), mark: markOf(state.path, breaks) };
    if (isContainer(state) && open.has(state.path)) {
      graph.groups.push({ ...box, title: title + ' (' + [state.kind, wordOf(life)].filter((part) => part !== '').join(', ') + ')', expanded: true });
    } else {
      graph.nodes.push({ ...box, title, isWide: true, detail: detailOf(state, life, life === 'waiting' ? waits.get(state.path) : undefined, breaks, inside.get(state.path) ?? 0), expanded: isContainer(state) ? false : undefined });
    }
  }
  const edges = new Map<string, GraphEdge>();
  const add = (source: string, target: string, label: string, look: string) => {
    const id = look + ' ' + source + ' ' + target;
    const known = edges.get(id);
    edges.set(id, { id, source: idOf(source), target: idOf(target), label: known?.label ? known.label + ', ' + label : label, look });
  };
  for (const state of states) {
    for (const { outcome, to } of state.next) if (to !== undefined) add(state.path, to, outcome, 'transition');
    if (withFlows) for (const flow of state.flows ?? []) if (open.has(state.path)) add(flow.from, flow.to, flow.what, 'flow');
  }
  if (withFlows && root && !states.includes(root)) for (const flow of root.flows ?? []) add(flow.from, flow.to, flow.what, 'flow');
  graph.edges = [...edges.values()].filter((edge) => edge.source !== edge.target || edge.look === 'transition');
  return graph;
}
