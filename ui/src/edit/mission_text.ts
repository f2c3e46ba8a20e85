// SPDX-License-Identifier: Apache-2.0
import { isAlias, isMap, isScalar, type Document, type YAMLMap } from 'yaml';
import { isMap as isRecord, type Json } from '../robot/change';
import { documentIn, record, startOf, type Path } from './yaml_edit';

/** Missions as texts (docs/missions.md): what of them is drawn and edited. Edits are in mission_edits.ts. */

export interface MissionPort {
  name: string;
  type: string;
  /** undefined: none. */
  default?: unknown;
}

/** The interface of an action or a library, which a state can use. */
export interface Interface {
  name: string;
  description: string;
  inputs: MissionPort[];
  outputs: MissionPort[];
  outcomes: string[];
}

/** An action of a mission, with all that is declared about it. */
export interface ActionText extends Interface {
  value: Record<string, unknown>;
}

export interface EditedState {
  /** The path of its map in the text. */
  path: Path;
  /** Names from the root of its machine, joined by '/'; '': that root. */
  id: string;
  name: string;
  kind: string;
  action: string;
  library: string;
  title: string;
  description: string;
  /** Target: a sibling, or "return OUTCOME". */
  on: { outcome: string; target: string }[];
  start: string;
  /** Ports that a container declares; empty for leaves. */
  inputs: MissionPort[];
  outputs: MissionPort[];
  variables: MissionPort[];
  outcomes: string[];
  /** The facts and resources that a container declares, and the world and resources of the mission, as they are written; empty for leaves. */
  declares: Record<string, unknown>;
  /** null: not written as two ports. */
  flows: ({ from: string; to: string } | null)[];
  children: EditedState[];
  parent: EditedState | null;
  /** The values that take the place of defaults in leaves and libraries, by port. */
  values: { inputs: Record<string, unknown>; outputs: Record<string, unknown> };
  at: number;
}

export interface Machine {
  /** '': the mission; else a library in its file. */
  name: string;
  root: EditedState;
}

export interface MissionText {
  name: string;
  actions: ActionText[];
  machines: Machine[];
}

export const extraOutcomes = ['aborted', 'preempted'];
const containers = ['hierarchy', 'barrier', 'preemptive'];
export const isContainer = (state: EditedState) => containers.includes(state.kind);

const textOf = (value: unknown) => (typeof value === 'string' || typeof value === 'number' || typeof value === 'boolean' ? String(value) : '');

function portsOf(value: unknown): MissionPort[] {
  return Object.entries(record(value)).map(([name, port]) => {
    const { type, default: given } = record(port);
    return typeof port === 'object' && port !== null ? { name, type: textOf(type) || 'any', default: given } : { name, type: textOf(port) || 'any' };
  });
}
const outcomesOf = (value: unknown) => (Array.isArray(value) ? value.map(textOf) : ['success']);

function interfaceOf(name: string, value: unknown): Interface {
  const { description, inputs, outputs, outcomes } = record(value);
  return { name, description: textOf(description), inputs: portsOf(inputs), outputs: portsOf(outputs), outcomes: outcomesOf(outcomes) };
}

function flowOf(value: unknown): { from: string; to: string } | null {
  if (typeof value === 'string') {
    const arrow = value.indexOf(' -> ');
    return arrow < 0 ? null : { from: value.slice(0, arrow), to: value.slice(arrow + 4) };
  }
  const { from, to } = record(value);
  return typeof from === 'string' && typeof to === 'string' ? { from, to } : null;
}

/** The entries of a map in their order; keys that look like numbers would be sorted. */
function entriesOf(document: Document, node: unknown): { name: string; node: unknown; at: number }[] {
  const map = isAlias(node) ? node.resolve(document) : node;
  return isMap(map) ? (map as YAMLMap).items.map((pair) => ({ name: String(isScalar(pair.key) ? pair.key.value : pair.key), node: pair.value, at: startOf(pair) })) : [];
}

class Reader {
  constructor(private readonly document: Document) {}

  state(name: string, node: unknown, js: unknown, path: Path, parent: EditedState | null, at: number): EditedState {
    const map = isAlias(node) ? node.resolve(this.document) : node;
    const value = record(js);
    const hasStates = typeof value['states'] === 'object' && value['states'] !== null;
    const kind = textOf(value['kind']) || (hasStates ? 'hierarchy' : 'library' in value ? 'library' : parent === null ? 'hierarchy' : 'execution');
    const isLeaf = !containers.includes(kind);
    const on = isMap(map) ? entriesOf(this.document, map.get('on', true)).map((one) => ({ outcome: one.name, target: textOf(record(value['on'])[one.name]) })) : [];
    const state: EditedState = {
      path, name, kind, parent, at, on,
      id: parent === null ? '' : parent.id === '' ? name : parent.id + '/' + name,
      action: kind === 'execution' || kind === 'decider' ? textOf(value['action']) || name : '',
      library: textOf(value['library']), title: textOf(value['title']), description: textOf(value['description']), start: textOf(value['start']),
      inputs: isLeaf ? [] : portsOf(value['inputs']), outputs: isLeaf ? [] : portsOf(value['outputs']), variables: isLeaf ? [] : portsOf(value['variables']),
      outcomes: isLeaf ? [] : outcomesOf(value['outcomes']),
      declares: isLeaf ? {} : Object.fromEntries(['preconditions', 'resources', 'world'].filter((key) => key in value).map((key) => [key, value[key]])),
      flows: Array.isArray(value['flows']) ? value['flows'].map(flowOf) : [],
      values: { inputs: isLeaf ? record(value['inputs']) : {}, outputs: isLeaf ? record(value['outputs']) : {} },
      children: [],
    };
    const states = isMap(map) ? entriesOf(this.document, map.get('states', true)) : [];
    state.children = states.map((one) => this.state(one.name, one.node, record(value['states'])[one.name], [...path, 'states', one.name], state, one.at));
    return state;
  }
}

/** The mission in a text; null where the text is none or cannot be parsed. */
export function missionIn(text: string): MissionText | null {
  const document = documentIn(text);
  if (!document || !isMap(document.contents) || !document.contents.has('mission')) return null;
  let root: Record<string, unknown>;
  try {
    root = record(document.toJS());
  } catch {
    return null;
  }
  const name = textOf(root['mission']);
  const reader = new Reader(document);
  const libraries = entriesOf(document, document.get('libraries', true)).map((one) => ({
    name: one.name, root: reader.state(one.name, one.node, record(root['libraries'])[one.name], ['libraries', one.name], null, one.at),
  }));
  return {
    name,
    actions: entriesOf(document, document.get('actions', true)).map((one) => ({ ...interfaceOf(one.name, record(root['actions'])[one.name]), value: record(record(root['actions'])[one.name]) })),
    machines: [{ name: '', root: reader.state(name, document.contents, root, [], null, 0) }, ...libraries],
  };
}

export function statesOf(root: EditedState): EditedState[] {
  return [root, ...root.children.flatMap(statesOf)];
}
export function stateIn(root: EditedState, id: string | null): EditedState | null {
  return id === null ? null : (statesOf(root).find((state) => state.id === id) ?? null);
}

/** The libraries in the answer to the request `libraries`. */
export function librariesOf(value: Json): Interface[] {
  const list = isRecord(value) ? value['libraries'] : null;
  return (Array.isArray(list) ? list : []).flatMap((one) => {
    if (!isRecord(one)) return [];
    const ports = (key: string) => (Array.isArray(one[key]) ? (one[key] as Json[]) : []).map((port) => {
      const { name, type, default: given } = record(port);
      return { name: textOf(name), type: textOf(type) || 'any', default: given ?? undefined };
    });
    return [{ name: textOf(one['name']), description: textOf(one['description']), inputs: ports('inputs'), outputs: ports('outputs'), outcomes: outcomesOf(one['outcomes']) }];
  });
}

/** The libraries that a mission can use: those in its file, and those in other files. */
export function allLibraries(mission: MissionText, files: Interface[]): Interface[] {
  const own = mission.machines.filter((machine) => machine.name !== '').map(({ name, root }) => ({ name, description: root.description, inputs: root.inputs, outputs: root.outputs, outcomes: root.outcomes }));
  return [...own, ...files.filter((file) => !own.some((one) => one.name === file.name))];
}

/** The ports and outcomes of a state; null where what it stands for is not known. */
export function interfaceIn(mission: MissionText, libraries: Interface[], state: EditedState): Interface | null {
  if (isContainer(state)) return { name: state.name, description: state.description, inputs: state.inputs, outputs: state.outputs, outcomes: state.outcomes };
  if (state.kind === 'library') return libraries.find((one) => one.name === state.library) ?? null;
  return mission.actions.find((one) => one.name === state.action) ?? null;
}

/**
 * The outcomes of a state, with those that have transitions although the state's action or library is not known or does
 * not have them.
 */
export function outcomesIn(mission: MissionText, libraries: Interface[], state: EditedState): string[] {
  const known = interfaceIn(mission, libraries, state)?.outcomes ?? [];
  return [...new Set([...known, ...state.on.map((one) => one.outcome)])];
}

/** Where a transition of the state can lead: siblings, and outcomes of its container. */
export function targetsOf(state: EditedState): string[] {
  const around = state.parent;
  if (!around) return [];
  const siblings = around.kind === 'hierarchy' ? around.children.map((one) => one.name) : [];
  return [...siblings, ...[...around.outcomes, ...extraOutcomes].map((outcome) => 'return ' + outcome)];
}

export interface FlowEnd {
  /** "look.pose", "inputs.box". */
  ref: string;
  type: string;
}

const own = (container: EditedState, which: 'inputs' | 'outputs' | 'variables'): FlowEnd[] => container[which].map((port) => ({ ref: which + '.' + port.name, type: port.type }));

/** The ends in a container from which values can come, or to which they can go. */
export function flowEnds(mission: MissionText, libraries: Interface[], container: EditedState, side: 'from' | 'to'): FlowEnd[] {
  const inner = container.children.flatMap((state) => (interfaceIn(mission, libraries, state)?.[side === 'from' ? 'outputs' : 'inputs'] ?? []).map((port) => ({ ref: state.name + '.' + port.name, type: port.type })));
  return [...own(container, side === 'from' ? 'inputs' : 'outputs'), ...own(container, 'variables'), ...inner];
}

/** Whether a value of type `from` can flow to a port of type `to`, by the rule of mission::connects(). */
export function connects(from: string, to: string): boolean {
  return from === to || from === 'any' || to === 'any' || (from === 'int' && to === 'float');
}

/** Why values cannot flow so; null: they can. */
export function flowRefusal(mission: MissionText, libraries: Interface[], container: EditedState, from: string, to: string): string | null {
  const source = flowEnds(mission, libraries, container, 'from').find((one) => one.ref === from);
  const sink = flowEnds(mission, libraries, container, 'to').find((one) => one.ref === to);
  if (!source) return from + ' has no values';
  if (!sink) return to + ' takes no values';
  if (from === to) return 'a variable keeps its value';
  if (!connects(source.type, sink.type)) return from + ' has the type ' + source.type + ', ' + to + ' the type ' + sink.type;
  if (container.flows.some((one) => one?.from === from && one.to === to)) return 'there is this data flow already';
  return null;
}

/** "look", "look_2" where there is one. */
export function newName(container: EditedState, wanted: string): string {
  const base = wanted.replace(/[^A-Za-z0-9_:-]+/g, '_').replace(/^[^A-Za-z0-9_]+/, '') || 'state';
  const taken = new Set(['inputs', 'outputs', 'variables', ...container.children.map((one) => one.name)]);
  let name = base;
  for (let number = 2; taken.has(name); ++number) name = base + '_' + number;
  return name;
}
