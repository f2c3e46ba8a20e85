// SPDX-License-Identifier: Apache-2.0
import { taskOf, type Status } from '../robot/types';
import { labelWidth, type GraphEdge, type GraphGroup, type GraphNode } from './drawn_graph';
import { placeOf, rateText, titleOf, toneOf, type Flows } from './graph';
import { microsecondsText } from '../units';

/** A process, or a host with several processes. */
export interface Place {
  id: string;
  title: string;
  /** The host around it. */
  inside?: string;
  /** Sorted; of a host: those of its processes. */
  tasks: string[];
}

export interface Wire {
  source: string;
  target: string;
  /** The connection in the status. */
  key: string;
}

/** The places of all tasks. */
export interface Structure {
  /** Hosts before their processes; the first process is the runtime's own. */
  places: Place[];
  byId: Map<string, Place>;
  /** The process of each task. */
  placeOf: Map<string, Place>;
  wires: Wire[];
}

/** The edge between two tasks or folded places, and the connections that it stands for. */
export interface Bundle {
  id: string;
  source: string;
  target: string;
  connections: string[];
  folded: boolean;
}

/** Networks with more tasks begin folded. */
export const mostOpen = 100;

const compare = new Intl.Collator(undefined, { numeric: true }).compare;

export function structureOf(status: Status): Structure {
  const processes = new Map<string, Place>();
  const ofHost = new Map<string, Place[]>();
  const home = new Map<string, Place>();
  for (const task of Object.values(status.tasks)) {
    const name = placeOf(task);
    let place = processes.get(name);
    if (!place) {
      place = { id: 'group:' + name, title: titleOf(name), tasks: [] };
      processes.set(name, place);
      ofHost.set(task.host, [...(ofHost.get(task.host) ?? []), place]);
    }
    place.tasks.push(task.id);
    home.set(task.id, place);
  }
  const hosts: Place[] = [];
  for (const [host, inside] of ofHost) {
    if (host === '' || inside.length < 2) continue;
    const around: Place = { id: 'host:' + host, title: host, tasks: inside.flatMap((place) => place.tasks) };
    hosts.push(around);
    for (const place of inside) {
      place.inside = around.id;
      place.title = place.id.slice('group:'.length + host.length).replace(/^ \/ /, '') || host;
    }
  }
  const byTitle = (a: Place, b: Place) => (a.id === 'group:' ? -1 : b.id === 'group:' ? 1 : compare(a.title, b.title));
  const places = [...hosts.sort(byTitle), ...[...processes.values()].sort(byTitle)];
  for (const place of places) place.tasks.sort(compare);
  return {
    places,
    byId: new Map(places.map((place) => [place.id, place])),
    placeOf: home,
    wires: Object.entries(status.connections).map(([key, one]) => ({ key, source: taskOf(one.from), target: taskOf(one.to) })),
  };
}

/** Whether both have the same tasks in the same places, and the same connections. */
export function sameStructure(a: Status, b: Status): boolean {
  if (a.tasks === b.tasks && a.connections === b.connections) return true;
  const tasks = Object.values(b.tasks);
  const keys = Object.keys(b.connections);
  return (
    Object.keys(a.tasks).length === tasks.length &&
    Object.keys(a.connections).length === keys.length &&
    tasks.every((task) => {
      const before = a.tasks[task.id];
      return before !== undefined && before.host === task.host && before.process === task.process;
    }) &&
    keys.every((key) => a.connections[key] !== undefined)
  );
}

/** The outermost folded place around a task; null: the task can be seen. */
export function foldedAround(structure: Structure, task: string, isFolded: (place: string) => boolean): Place | null {
  const place = structure.placeOf.get(task);
  const host = place?.inside === undefined ? undefined : structure.byId.get(place.inside);
  if (host && isFolded(host.id)) return host;
  return place && isFolded(place.id) ? place : null;
}

/** Edges between what can be seen; those within a folded place are none. */
export function bundlesOf(structure: Structure, isFolded: (place: string) => boolean): Bundle[] {
  const seen = new Map<string, string>();
  const shown = (task: string) => {
    const known = seen.get(task);
    if (known !== undefined) return known;
    const found = foldedAround(structure, task, isFolded)?.id ?? task;
    seen.set(task, found);
    return found;
  };
  const bundles = new Map<string, Bundle>();
  for (const wire of structure.wires) {
    const source = shown(wire.source);
    const target = shown(wire.target);
    const folded = source !== wire.source || target !== wire.target;
    if (source === target && folded) continue;
    const id = source + ' -> ' + target;
    const bundle = bundles.get(id);
    if (bundle) bundle.connections.push(wire.key);
    else bundles.set(id, { id, source, target, connections: [wire.key], folded });
  }
  return [...bundles.values()];
}

/** How a folded place is drawn: how many tasks it has, how many are in trouble, and how many were found. */
function foldedNode(place: Place, status: Status, found: Set<string> | null): GraphNode {
  const tones = place.tasks.map((id) => toneOf(status.tasks[id]?.state ?? ''));
  const worst = (['bad', 'warn', 'good'] as const).find((tone) => tones.includes(tone)) ?? 'idle';
  const trouble = tones.filter((tone) => tone === 'bad' || tone === 'warn').length;
  const hits = found ? place.tasks.filter((task) => found.has(task)).length : 0;
  const detail = [
    place.tasks.length + (place.tasks.length === 1 ? ' task' : ' tasks'),
    trouble > 0 ? trouble + ' in trouble' : '',
    hits > 0 ? hits + ' found' : '',
  ];
  return {
    id: place.id, group: place.inside, title: '▸ ' + place.title, isWide: true, detail: detail.filter((part) => part !== '').join(', '), folded: true,
    look: 'tone-' + worst + (found && hits === 0 ? ' faint' : ''),
  };
}

/** The picture of a network in which some places are folded; elements that were not `found` are dimmed. */
export function pictureOf(status: Status, structure: Structure, isFolded: (place: string) => boolean, found: Set<string> | null): { groups: GraphGroup[]; nodes: GraphNode[] } {
  const groups: GraphGroup[] = [];
  const nodes: GraphNode[] = [];
  for (const place of structure.places) {
    if (place.inside !== undefined && isFolded(place.inside)) continue;
    if (isFolded(place.id)) {
      nodes.push(foldedNode(place, status, found));
      continue;
    }
    groups.push({ id: place.id, group: place.inside, title: '▾ ' + place.title });
    if (place.id.startsWith('host:')) continue;
    for (const id of place.tasks) {
      const task = status.tasks[id];
      if (!task) continue;
      nodes.push({
        id, group: place.id, title: id, detail: task.state_name || task.state, look: 'tone-' + toneOf(task.state) + (found && !found.has(id) ? ' faint' : ''),
      });
    }
  }
  return { groups, nodes };
}

/** "×3, 120/s, 3.1 µs, 4 dropped" (of three connections: the longest latency), as far as there is something to say. */
export function labelOf(status: Status, flows: Flows, { connections, folded }: Bundle): string {
  let rate = 0;
  let latency: number | null = null;
  let dropped = 0;
  for (const key of connections) {
    const flow = flows.get(key);
    rate += flow?.rate ?? 0;
    if (flow && flow.latency !== null) latency = Math.max(latency ?? 0, flow.latency);
    dropped += status.connections[key]?.dropped ?? 0;
  }
  return [
    folded && connections.length > 1 ? '×' + connections.length : '',
    rateText(rate),
    latency !== null ? microsecondsText(latency) : '',
    dropped > 0 ? dropped + ' dropped' : '',
  ]
    .filter((part) => part !== '')
    .join(', ');
}

export function edgesOf(status: Status, flows: Flows, bundles: Bundle[]): GraphEdge[] {
  return bundles.map((bundle) => ({
    id: bundle.id, source: bundle.source, target: bundle.target, label: labelOf(status, flows, bundle), room: labelWidth(bundle.folded ? '×12, 120/s, 3.1 µs' : '120/s, 3.1 µs'),
    look: bundle.connections.some((key) => (status.connections[key]?.dropped ?? 0) > 0) ? 'warns' : '',
  }));
}
