// SPDX-License-Identifier: Apache-2.0
import { parse } from 'yaml';
import { addOutcome, addPort, removeFlow, setPort, setTransition, setUse, setValue } from './mission_edits';
import { isContainer, statesOf, type ActionText, type EditedState, type MissionPort, type MissionText } from './mission_text';
import { add, nodeAt, parsed, put, record, remove, type Path } from './yaml_edit';

/** Edits of what actions of missions declare, each from text to text (yaml_edit.ts). Mission and action are of the text as it is. */

export type Side = 'inputs' | 'outputs';

export const facts = [
  { key: 'preconditions', doc: 'such as !held({box}); checked when it begins' },
  { key: 'while', doc: 'must hold until it has ended, where it is observed on a robot' },
  { key: 'effects', doc: 'such as +held({box}); come true when it ends as expected' },
] as const;

export const flags = [
  { key: 'pure', doc: 'its result may be discarded' },
  { key: 'sensing', doc: 'observes reality, may be repeated' },
  { key: 'reads_world', doc: 'looks at facts that it does not declare' },
  { key: 'strict', doc: 'waits until nothing before it can fail' },
] as const;

/** The keys of each way to run an action; a way without keys is one value. */
const waysToRun: Record<string, string[]> = {
  controller: ['controller', 'set', 'call', 'write', 'until', 'outputs', 'afterwards'],
  pool: ['pool', 'call', 'outputs', 'outcome_from', 'timeout'],
};

export interface RunEntry {
  /** In the action. */
  path: Path;
  label: string;
  value: unknown;
}

/** The way in which the action runs, in parts that can be edited one by one. */
export function runEntries(action: ActionText): RunEntry[] {
  const run = record(action.value['run']);
  const way = Object.keys(waysToRun).find((key) => key in run);
  const known = way === undefined ? [] : (waysToRun[way] ?? []);
  const others = Object.keys(run).filter((key) => !known.includes(key));
  return [...known, ...others].flatMap((key) => {
    if (key !== 'simulated') return [{ path: ['run', key], label: key, value: run[key] }];
    const simulated = record(run['simulated']);
    const entries = ['duration', 'outcomes', 'outputs', 'error'];
    return entries.map((entry) => ({ path: ['run', 'simulated', entry], label: 'simulated ' + entry, value: simulated[entry] }));
  });
}

export const pathOf = (action: ActionText): Path => ['actions', action.name];

/** The states that stand for it, in all machines of the mission. */
export function usersOf(mission: MissionText, action: ActionText): EditedState[] {
  return mission.machines.flatMap((machine) => statesOf(machine.root)).filter((state) => !isContainer(state) && state.kind !== 'library' && state.action === action.name);
}

/** Comments in more lines would be lost with what they are beside. */
function checkOneLine(text: string, path: Path): void {
  const range = (nodeAt(parsed(text), path) as { range?: [number, number, number] } | undefined)?.range;
  if (range && text.slice(range[0], range[1]).trim().includes('\n')) throw new Error('this is written over several lines; edit it in the text');
}

/** Takes out what is at the path in the holder, an action or container, and what would be left empty around it. */
function removeDeclared(text: string, holder: Path, path: Path): string {
  const full = [...holder, ...path];
  if (nodeAt(parsed(text), full) === undefined) return text;
  const around = nodeAt(parsed(text), full.slice(0, -1)) as { items?: unknown[] };
  return remove(text, path.length > 1 && around.items?.length === 1 ? full.slice(0, -1) : full);
}

/** Something to run stays. */
function removeEntry(text: string, action: ActionText, path: Path): string {
  const full = [...pathOf(action), ...path];
  if (path[0] !== 'run' || nodeAt(parsed(text), full) === undefined) return removeDeclared(text, pathOf(action), path);
  const isWay = path.length === 2 && (String(path[1]) in waysToRun || Object.keys(record(action.value['run'])).length === 1);
  if (isWay) throw new Error('without this it would run nothing');
  return remove(text, full);
}

function putTyped(text: string, full: Path, typed: string, kind: 'text' | 'yaml'): string {
  return kind === 'text' ? put(text, full, typed) : put(text, full, parse(typed), typed.includes('\n') ? [] : [typed]);
}

/** Sets what is at the path in the action: text, or a value in YAML as it is typed; empty: nothing. */
export function setEntry(text: string, action: ActionText, path: Path, typed: string, kind: 'text' | 'yaml'): string {
  const full = [...pathOf(action), ...path];
  checkOneLine(text, full);
  const given = typed.trim();
  return given === '' ? removeEntry(text, action, path) : putTyped(text, full, given, kind);
}

/** As setEntry(), of what a container or the mission declares. */
export function setDeclared(text: string, container: EditedState, path: Path, typed: string, kind: 'text' | 'yaml'): string {
  const full = [...container.path, ...path];
  checkOneLine(text, full);
  const given = typed.trim();
  return given === '' ? removeDeclared(text, container.path, path) : putTyped(text, full, given, kind);
}

/** Adds an entry at the end of a list of an action or container; makes the list where there is none yet. */
export function addEntry(text: string, holder: Path, key: string, typed: string, kind: 'text' | 'yaml'): string {
  return add(text, [...holder, key], kind === 'text' ? typed.trim() : parse(typed));
}

export function setFlag(text: string, action: ActionText, flag: string, on: boolean): string {
  return on ? put(text, [...pathOf(action), flag], true) : removeEntry(text, action, [flag]);
}

const holderOf = (action: ActionText) => ({ ...action, path: pathOf(action), variables: [] });

export function addActionPort(text: string, action: ActionText, side: Side, name: string, type: string): string {
  return addPort(text, holderOf(action), side, name, type);
}

/** `yaml` empty: no default. */
export function setActionPort(text: string, action: ActionText, side: Side, port: MissionPort, type: string, yaml: string): string {
  checkOneLine(text, [...pathOf(action), side, port.name]);
  return setPort(text, holderOf(action), side, port, type, yaml);
}

/** Removes the port with the values that states give to it, and the data flows from or to it. */
export function removeActionPort(text: string, mission: MissionText, action: ActionText, side: Side, name: string): string {
  const users = usersOf(mission, action);
  let left = text;
  for (const container of new Set(users.flatMap((state) => state.parent ?? []))) {
    const refs = users.filter((state) => state.parent === container).map((state) => state.name + '.' + name);
    for (let index = container.flows.length - 1; index >= 0; --index) {
      const flow = container.flows[index];
      if (flow && refs.includes(side === 'inputs' ? flow.to : flow.from)) left = removeFlow(left, container, index);
    }
  }
  for (const state of users) if (name in state.values[side]) left = setValue(left, state, side, name, '');
  return removeEntry(left, action, [side, name]);
}

export function addActionOutcome(text: string, action: ActionText, name: string): string {
  return addOutcome(text, holderOf(action), name);
}

/** Removes the outcome with the transitions of states that stand for the action, and where it was expected. */
export function removeActionOutcome(text: string, mission: MissionText, action: ActionText, name: string): string {
  if (action.outcomes.length === 1) throw new Error('an action has one outcome at least');
  let left = remove(text, [...pathOf(action), 'outcomes', action.outcomes.indexOf(name)]);
  for (const state of usersOf(mission, action)) if (state.on.some((one) => one.outcome === name)) left = setTransition(left, state, name, null);
  return record(action.value['expect'])['outcome'] === name ? removeEntry(left, action, ['expect', 'outcome']) : left;
}

/** One that takes a second and does nothing yet; the state stands for it from then on. */
export function addAction(text: string, mission: MissionText, state: EditedState, name: string): string {
  if (!/^\w[\w.:-]*$/.test(name)) throw new Error('an action is named by letters, digits, _, -, . and :');
  if (mission.actions.some((one) => one.name === name)) throw new Error('there is an action ' + name + ' already');
  return setUse(put(text, ['actions', name], { run: { simulated: { duration: '1s' } } }), state, name);
}
