// SPDX-License-Identifier: Apache-2.0
import { flowEnds, flowRefusal, interfaceIn, isContainer, outcomesIn, statesOf, targetsOf, type EditedState, type Interface, type MissionText } from './mission_text';
import type { End, GraphPort, PortEdge, PortGroup, PortNode } from './PortGraph';

/** The view of a machine of a mission: how states follow each other, or how values flow. */
export type Shown = 'transitions' | 'flows';

export interface MissionGraph {
  groups: PortGroup[];
  nodes: PortNode[];
  edges: PortEdge[];
}

/** A machine with more states shows only its outermost containers open at first. */
const mostOpen = 40;

export const stateNode = (id: string) => 'state:' + id;
const startNode = (container: string) => 'start:' + container;
const endNode = (container: string, outcome: string) => 'end:' + container + ':' + outcome;
const ownNode = (container: string, which: string) => which + ':' + container;
/** The state of a node; null: the node is none. */
export const stateOfNode = (node: string) => (node.startsWith('state:') ? node.slice('state:'.length) : null);

export function openAtFirst(root: EditedState): Set<string> {
  const open = new Set<string>();
  let shown = 0;
  const queue = [root];
  for (let state = queue.shift(); state; state = queue.shift()) {
    shown += state.children.length;
    if (state !== root && shown > mostOpen) continue;
    if (isContainer(state)) open.add(state.id);
    queue.push(...state.children);
  }
  return open;
}

const port = (id: string, side: 'input' | 'output', label: string, title = ''): GraphPort => ({ id, side, label, title });

function portsOf(mission: MissionText, libraries: Interface[], state: EditedState, shown: Shown): GraphPort[] {
  if (shown === 'transitions') return [port('in', 'input', ''), ...outcomesIn(mission, libraries, state).map((outcome) => port(outcome, 'output', outcome, 'outcome'))];
  const known = interfaceIn(mission, libraries, state);
  return [...(known?.inputs ?? []).map((one) => port(one.name, 'input', one.name, one.type)), ...(known?.outputs ?? []).map((one) => port(one.name, 'output', one.name, one.type))];
}

function detailOf(state: EditedState): string {
  if (isContainer(state)) return state.kind + ', closed';
  if (state.kind === 'library') return 'library ' + state.library;
  return (state.kind === 'decider' ? 'decider: ' : '') + state.action;
}

/** The ends of transitions in a container, and where it starts; or its own ports. */
function innerNodes(container: EditedState, group: string | undefined, shown: Shown): PortNode[] {
  const small = (id: string, title: string, ports: GraphPort[]): PortNode => ({ id, group, title, look: 'life-idle', ports });
  if (shown === 'flows') {
    return (['inputs', 'variables', 'outputs'] as const)
      .filter((which) => container[which].length > 0)
      .map((which) => small(ownNode(container.id, which), which, container[which].flatMap((one) => [
        ...(which !== 'inputs' ? [port(one.name, 'input', one.name, one.type)] : []), ...(which !== 'outputs' ? [port(one.name, 'output', which === 'variables' ? '' : one.name, one.type)] : []),
      ])));
  }
  const returned = new Set([...container.outcomes, ...[container.start, ...container.children.flatMap((state) => state.on.map((one) => one.target))].flatMap((target) => (target.startsWith('return ') ? [target.slice(7)] : []))]);
  const ends = [...returned].map((outcome) => small(endNode(container.id, outcome), '↩ ' + outcome, [port('in', 'input', '')]));
  return container.kind === 'hierarchy' ? [small(startNode(container.id), '▶ start', [port('start', 'output', '')]), ...ends] : ends;
}

const targetNode = (container: EditedState, target: string) => (target.startsWith('return ') ? endNode(container.id, target.slice(7)) : stateNode(container.children.find((one) => one.name === target)?.id ?? ''));

function transitionsIn(container: EditedState): PortEdge[] {
  const edges = container.children.flatMap((state) =>
    state.on.map(({ outcome, target }) => ({ id: 'on ' + state.id + ' ' + outcome, source: stateNode(state.id), sourcePort: outcome, target: targetNode(container, target), targetPort: 'in' })),
  );
  if (container.start === '') return edges;
  return [...edges, { id: 'start ' + container.id, source: startNode(container.id), sourcePort: 'start', target: targetNode(container, container.start), targetPort: 'in' }];
}

/** "look.pose" in a container, as an end in the graph. */
function endOf(container: EditedState, ref: string): End {
  const dot = ref.indexOf('.');
  const owner = ref.slice(0, dot);
  const own = ['inputs', 'outputs', 'variables'].includes(owner);
  return { node: own ? ownNode(container.id, owner) : stateNode(container.children.find((one) => one.name === owner)?.id ?? ''), port: ref.slice(dot + 1) };
}
function flowsIn(container: EditedState): PortEdge[] {
  return container.flows.flatMap((flow, index) => {
    if (!flow) return [];
    const [from, to] = [endOf(container, flow.from), endOf(container, flow.to)];
    return [{ id: 'flow ' + index + ' ' + container.id, source: from.node, sourcePort: from.port, target: to.node, targetPort: to.port, look: 'flow' }];
  });
}

export function missionGraph(mission: MissionText, libraries: Interface[], root: EditedState, open: Set<string>, shown: Shown): MissionGraph {
  const graph: MissionGraph = { groups: [], nodes: [], edges: [] };
  const draw = (container: EditedState, group: string | undefined) => {
    graph.nodes.push(...innerNodes(container, group, shown));
    graph.edges.push(...(shown === 'flows' ? flowsIn(container) : transitionsIn(container)));
    for (const state of container.children) {
      const id = stateNode(state.id);
      const ports = portsOf(mission, libraries, state, shown);
      const title = state.title || state.name;
      if (isContainer(state) && open.has(state.id)) {
        graph.groups.push({ id, group, title: '▾ ' + title + ' (' + state.kind + ')', ports, isEdited: true });
        draw(state, id);
      } else {
        const known = interfaceIn(mission, libraries, state) !== null;
        graph.nodes.push({ id, group, title: (isContainer(state) ? '▸ ' : '') + title, detail: detailOf(state), look: known ? 'tone-idle' : 'tone-warn', ports });
      }
    }
  };
  draw(root, undefined);
  return graph;
}

/** The edit that drawing from one end to another one makes; null: none. */
export type Drawn = { state: EditedState; outcome: string; target: string } | { container: EditedState; start: string } | { container: EditedState; from: string; to: string };

function targetOf(container: EditedState, node: string): string | null {
  const end = 'end:' + container.id + ':';
  if (node.startsWith(end)) return 'return ' + node.slice(end.length);
  return container.children.find((one) => stateNode(one.id) === node)?.name ?? null;
}
function refOf(container: EditedState, end: End): string | null {
  for (const which of ['inputs', 'outputs', 'variables']) if (ownNode(container.id, which) === end.node) return which + '.' + end.port;
  const state = container.children.find((one) => stateNode(one.id) === end.node);
  return state ? state.name + '.' + end.port : null;
}

export function meaningOf(mission: MissionText, libraries: Interface[], root: EditedState, shown: Shown, from: End, to: End): Drawn | null {
  for (const container of statesOf(root).filter(isContainer)) {
    if (shown === 'flows') {
      const [source, sink] = [refOf(container, from), refOf(container, to)];
      if (source !== null && sink !== null) return flowRefusal(mission, libraries, container, source, sink) === null ? { container, from: source, to: sink } : null;
      continue;
    }
    const target = targetOf(container, to.node);
    if (target === null) continue;
    if (from.node === startNode(container.id)) return { container, start: target };
    const state = container.children.find((one) => stateNode(one.id) === from.node);
    if (state && targetsOf(state).includes(target)) return { state, outcome: from.port, target };
  }
  return null;
}

/** The ends that can be connected with a port of a state. */
export function flowPartners(mission: MissionText, libraries: Interface[], container: EditedState, ref: string, side: 'from' | 'to'): string[] {
  return flowEnds(mission, libraries, container, side === 'from' ? 'to' : 'from')
    .map((end) => end.ref)
    .filter((other) => (side === 'from' ? flowRefusal(mission, libraries, container, ref, other) : flowRefusal(mission, libraries, container, other, ref)) === null);
}
