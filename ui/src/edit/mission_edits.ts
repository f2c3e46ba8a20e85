// SPDX-License-Identifier: Apache-2.0
import { parse } from 'yaml';
import { isContainer, statesOf, type EditedState, type Interface, type MissionPort, type MissionText } from './mission_text';
import { add, move, nodeAt, parsed, put, record, remove, rename, type Path } from './yaml_edit';

/** Edits of missions, each from text to text (yaml_edit.ts). States are of the text as it is. */

const ownerOf = (ref: string) => ref.slice(0, ref.indexOf('.'));

function checkName(name: string, around: EditedState): void {
  if (!/^[A-Za-z0-9_][A-Za-z0-9_:-]*$/.test(name)) throw new Error('a state is named by letters, digits, _, - and :');
  if (['inputs', 'outputs', 'variables'].includes(name)) throw new Error('no state can be called ' + name + ': in data flows this means the ports of the container');
  if (around.children.some((one) => one.name === name)) throw new Error('there is a state ' + name + ' already');
}

function removeIfThere(text: string, path: Path): string {
  return nodeAt(parsed(text), path) === undefined ? text : remove(text, path);
}

export type NewState = { action: string } | { library: string } | { kind: string };

/** Adds a state at the end of a container; a hierarchy starts with its first state. */
export function addState(text: string, around: EditedState, name: string, what: NewState): string {
  checkName(name, around);
  const path = [...around.path, 'states', name];
  let added: string;
  if ('kind' in what) {
    const value = what.kind === 'hierarchy' ? { states: {} } : { kind: what.kind, states: {} };
    added = put(text, path, value, [what.kind === 'hierarchy' ? '\n  states: {}' : '\n  kind: ' + what.kind + '\n  states: {}']);
  } else if ('library' in what) {
    added = put(text, path, what);
  } else {
    added = put(text, path, what.action === name ? {} : what);
  }
  return around.kind === 'hierarchy' && around.start === '' ? put(added, [...around.path, 'start'], name) : added;
}

/** The text without the mentions of a state in its container: as its start, in transitions of its siblings, in data flows. */
function withoutMentions(text: string, state: EditedState): string {
  const around = state.parent;
  if (!around) return text;
  let left = text;
  for (let index = around.flows.length - 1; index >= 0; --index) {
    const flow = around.flows[index];
    if (flow && (ownerOf(flow.from) === state.name || ownerOf(flow.to) === state.name)) left = remove(left, [...around.path, 'flows', index]);
  }
  for (const other of around.children) {
    if (other === state) continue;
    for (const { outcome, target } of other.on) if (target === state.name) left = setTransition(left, other, outcome, null);
  }
  return around.start === state.name ? remove(left, [...around.path, 'start']) : left;
}

/** Removes the state with the transitions to it and its data flows. */
export function removeState(text: string, state: EditedState): string {
  return remove(withoutMentions(text, state), state.path);
}

/** Rules of deciders in the container, of actions that no other container uses, name states too. */
function renameInRules(text: string, mission: MissionText, around: EditedState, name: string, to: string): string {
  const all = mission.machines.flatMap((machine) => statesOf(machine.root));
  let left = text;
  for (const decider of around.children.filter((one) => one.kind === 'decider')) {
    if (all.some((one) => one.action === decider.action && String(one.parent?.path) !== String(around.path))) continue;
    const path = ['actions', decider.action, 'run', 'decide'];
    const rules: unknown = path.reduce<unknown>((value, step) => record(value)[step], parsed(left).toJS());
    (Array.isArray(rules) ? rules : []).forEach((rule, index) => {
      if (name in record(record(rule)['when'])) left = rename(left, [...path, index, 'when', name], to);
    });
  }
  return left;
}

/** Renames the state and all that names it. */
export function renameState(text: string, mission: MissionText, state: EditedState, name: string): string {
  const around = state.parent;
  if (!around || name === state.name) return text;
  checkName(name, around);
  let left = text;
  const entry: unknown = state.path.reduce<unknown>((value, step) => record(value)[step], parsed(text).toJS());
  const hasAction = 'action' in record(entry);
  if (state.action !== '' && !hasAction && state.action !== name) left = put(left, [...state.path, 'action'], state.action);
  around.flows.forEach((flow, index) => {
    if (!flow || (ownerOf(flow.from) !== state.name && ownerOf(flow.to) !== state.name)) return;
    const renamed = (ref: string) => (ownerOf(ref) === state.name ? name + ref.slice(ref.indexOf('.')) : ref);
    const written = typeof (record(containerValue(text, around))['flows'] as unknown[])[index] === 'string';
    const path = [...around.path, 'flows', index];
    left = written ? put(left, path, renamed(flow.from) + ' -> ' + renamed(flow.to)) : put(put(left, [...path, 'from'], renamed(flow.from)), [...path, 'to'], renamed(flow.to));
  });
  for (const other of around.children) for (const { outcome, target } of other.on) if (target === state.name) left = put(left, [...other.path, 'on', outcome], name);
  if (around.start === state.name) left = put(left, [...around.path, 'start'], name);
  left = renameInRules(left, mission, around, state.name, name);
  return rename(left, state.path, name);
}
const containerValue = (text: string, container: EditedState): unknown => container.path.reduce<unknown>((value, step) => record(value)[step], parsed(text).toJS());

/**
 * Moves the state into another container, or before another state of its own (null: last). Transitions and data flows
 * between it and its old siblings are taken out; transitions to outcomes stay where the new container has them.
 */
export function moveState(text: string, state: EditedState, to: EditedState, before: string | null): string {
  if (state.parent && String(to.path) === String(state.parent.path)) return move(text, state.path, [...to.path, 'states'], before);
  if (!isContainer(to)) throw new Error(to.name + ' has no states');
  checkName(state.name, to);
  let left = withoutMentions(text, state);
  const kept = new Set([...to.outcomes, 'aborted', 'preempted'].map((outcome) => 'return ' + outcome));
  let rest: EditedState = state;
  for (const { outcome, target } of state.on) {
    if (kept.has(target)) continue;
    left = setTransition(left, rest, outcome, null);
    rest = { ...rest, on: rest.on.filter((one) => one.outcome !== outcome) };
  }
  const moved = move(left, state.path, [...to.path, 'states'], before);
  return to.kind === 'hierarchy' && to.start === '' ? put(moved, [...to.path, 'start'], state.name) : moved;
}

/** null: none. */
export function setTransition(text: string, state: EditedState, outcome: string, target: string | null): string {
  if (target !== null) return put(text, [...state.path, 'on', outcome], target);
  const on = nodeAt(parsed(text), [...state.path, 'on']) as { items?: unknown[] } | undefined;
  return removeIfThere(text, on?.items?.length === 1 ? [...state.path, 'on'] : [...state.path, 'on', outcome]);
}

export function setStart(text: string, container: EditedState, target: string): string {
  return put(text, [...container.path, 'start'], target);
}

export function addFlow(text: string, container: EditedState, from: string, to: string): string {
  const flow = from + ' -> ' + to;
  return add(text, [...container.path, 'flows'], from.includes(' -> ') || to.includes(' -> ') ? { from, to } : flow);
}
export function removeFlow(text: string, container: EditedState, index: number): string {
  return remove(text, [...container.path, 'flows', index]);
}

/** Sets the value that a state gives to a port in place of the default; `yaml` as it is typed, empty: the default. */
export function setValue(text: string, state: EditedState, side: 'inputs' | 'outputs', port: string, yaml: string): string {
  const typed = yaml.trim();
  if (typed !== '') return put(text, [...state.path, side, port], parse(yaml), typed.includes('\n') ? [] : [typed]);
  const only = Object.keys(state.values[side]).length === 1;
  return removeIfThere(text, [...state.path, side, ...(only ? [] : [port])]);
}

/** Empty: none. */
export function setText(text: string, state: EditedState, key: 'title' | 'description', value: string): string {
  return value.trim() === '' ? removeIfThere(text, [...state.path, key]) : put(text, [...state.path, key], value.trim());
}

/** Sets the kind of a container, or of a leaf: execution or decider. */
export function setKind(text: string, state: EditedState, kind: string): string {
  const left = kind === 'hierarchy' || kind === 'execution' ? removeIfThere(text, [...state.path, 'kind']) : put(text, [...state.path, 'kind'], kind);
  return kind === 'hierarchy' || !isContainer(state) ? left : removeIfThere(left, [...state.path, 'start']);
}

/** The action or library that it stands for. */
export function setUse(text: string, state: EditedState, name: string): string {
  return put(text, [...state.path, state.kind === 'library' ? 'library' : 'action'], name);
}

export function addOutcome(text: string, container: Pick<EditedState, 'path' | 'outcomes'>, name: string): string {
  if (name.trim() === '' || container.outcomes.includes(name)) throw new Error('an outcome needs a name of its own');
  const path = [...container.path, 'outcomes'];
  return nodeAt(parsed(text), path) === undefined ? put(text, path, [...container.outcomes, name]) : add(text, path, name);
}
/** Removes the outcome with the container's transition on it and its states' transitions to it. */
export function removeOutcome(text: string, container: EditedState, name: string): string {
  if (container.outcomes.length === 1) throw new Error('a container has one outcome at least');
  let left = remove(text, [...container.path, 'outcomes', container.outcomes.indexOf(name)]);
  if (container.on.some((one) => one.outcome === name)) left = setTransition(left, container, name, null);
  for (const state of container.children) for (const { outcome, target } of state.on) if (target === 'return ' + name) left = setTransition(left, state, outcome, null);
  return left;
}

/** A part of the mission that declares ports: a container, or an action. */
type PortHolder = Pick<EditedState, 'path' | 'inputs' | 'outputs' | 'variables'>;

export function addPort(text: string, container: PortHolder, which: 'inputs' | 'outputs' | 'variables', name: string, type: string): string {
  if (name.trim() === '' || container[which].some((port) => port.name === name)) throw new Error('a port needs a name of its own');
  return put(text, [...container.path, which, name], type);
}
/** Removes the port with its data flows in and around the container. */
export function removePort(text: string, container: EditedState, which: 'inputs' | 'outputs' | 'variables', name: string): string {
  let left = text;
  const drop = (holder: EditedState | null, ref: string) => {
    for (let index = (holder?.flows.length ?? 0) - 1; index >= 0; --index) {
      const flow = holder?.flows[index];
      if (holder && (flow?.from === ref || flow?.to === ref)) left = removeFlow(left, holder, index);
    }
  };
  drop(container, which + '.' + name);
  if (which !== 'variables') drop(container.parent, container.name + '.' + name);
  return removeIfThere(left, [...container.path, which, ...(container[which].length === 1 ? [] : [name])]);
}
/** `yaml` empty: no default. */
export function setPort(text: string, container: PortHolder, which: 'inputs' | 'outputs' | 'variables', port: MissionPort, type: string, yaml: string): string {
  const path = [...container.path, which, port.name];
  const value = yaml.trim() === '' ? type : { type, default: parse(yaml) as unknown };
  return put(text, path, value);
}

/** A mission that does nothing yet. */
export function newMission(name: string): string {
  return `mission: ${name}
actions:
  wait: {run: {simulated: {duration: 1s}}}
start: wait
states:
  wait: {on: {success: return success}}
`;
}
export const newNetwork = (name: string) => `network: ${name}\ntasks: {}\n`;

/** The interface that a state of that kind would have, for palettes. */
export function described(one: Interface): string {
  const ports = (list: MissionPort[]) => list.map((port) => port.name + ': ' + port.type).join(', ');
  return [one.description, one.inputs.length > 0 ? 'takes ' + ports(one.inputs) : '', one.outputs.length > 0 ? 'gives ' + ports(one.outputs) : '', 'ends as ' + one.outcomes.join(', ')].filter(Boolean).join('; ');
}
