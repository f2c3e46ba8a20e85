// SPDX-License-Identifier: Apache-2.0
import { isMap, isScalar, isSeq, parse } from 'yaml';
import { add, documentIn, nodeAt, parsed, put, record, remove, rename, startOf } from './yaml_edit';

/** Networks as texts, and edits of them (yaml_edit.ts), each from text to text. */

export interface NetworkTask {
  id: string;
  component: string;
  /** The values by the names of the properties. */
  properties: Record<string, unknown>;
  /** "host / process"; "": the runtime's own process. */
  place: string;
  /** Where it stands in the text. */
  at: number;
}

export interface NetworkConnection {
  from: string;
  to: string;
  at: number;
}

export interface NetworkText {
  tasks: NetworkTask[];
  /** In the order of the file; null for a connection that is not written as two ports. */
  connections: (NetworkConnection | null)[];
  /** Whether the functions below understand it: Rock's files they do not. */
  editable: boolean;
}

function ports(value: unknown): { from: string; to: string } | null {
  if (typeof value === 'string') {
    const [from, to, more] = value.split('->').map((part) => part.trim());
    return from && to && more === undefined ? { from, to } : null;
  }
  const { from, to } = record(value);
  return typeof from === 'string' && typeof to === 'string' ? { from, to } : null;
}

function placesOf(root: Record<string, unknown>): Map<string, string> {
  const places = new Map<string, string>();
  for (const [key, value] of Object.entries(record(root['deployments']))) {
    const { process, host, tasks } = record(value);
    const place = (typeof host === 'string' ? host + ' / ' : '') + (typeof process === 'string' ? process : key);
    const names = Array.isArray(tasks) ? tasks.map((task) => (typeof task === 'string' ? task : (Object.keys(record(task))[0] ?? ''))) : Object.keys(record(tasks));
    for (const name of names) if (!places.has(name)) places.set(name, place);
  }
  return places;
}

/** The network in a text; null where the text is none or cannot be parsed. */
export function networkIn(text: string): NetworkText | null {
  const document = documentIn(text);
  if (!document || !isMap(document.contents)) return null;
  let root: Record<string, unknown>;
  try {
    root = record(document.toJS());
  } catch {
    return null;
  }
  if (!('tasks' in root) && !('network' in root)) return null;
  const places = placesOf(root);
  const taskNodes = nodeAt(document, ['tasks']);
  const tasks = (isMap(taskNodes) ? taskNodes.items : []).map((pair) => {
    const id = String(isScalar(pair.key) ? pair.key.value : pair.key);
    const { component, type, properties } = record(record(root['tasks'])[id]);
    return { id, component: String(component ?? type ?? ''), properties: record(properties), place: places.get(id) ?? '', at: startOf(pair) };
  });
  const list = document.get('connections');
  const connections = (isSeq(list) ? list.items : []).map((item, index) => {
    const found = ports((root['connections'] as unknown[])[index]);
    return found ? { ...found, at: startOf(item) } : null;
  });
  return { tasks, connections, editable: 'network' in root && !(isMap(list) && list.items.length > 0) };
}

export function addTask(text: string, id: string, component: string): string {
  if (networkIn(text)?.tasks.some((task) => task.id === id)) throw new Error('there is a task ' + id + ' already');
  return put(text, ['tasks', id], { component }, ['{component: ' + JSON.stringify(component) + '}']);
}

/** Adds the first task of a text such as `segue ros2 describe NODE --model -` writes, as it is written there; its id, which is another one where that is taken. */
export function addWrittenTask(text: string, written: string): { text: string; id: string } {
  const network = networkIn(text);
  if (!network?.editable) throw new Error('this file is edited as text only');
  const [name, task] = Object.entries(record(record(parse(written))['tasks']))[0] ?? [];
  if (name === undefined) throw new Error('there is no task to be added');
  let id = name;
  for (let number = 2; network.tasks.some((one) => one.id === id); ++number) id = name + '_' + number;
  const lines = written.split('\n');
  const body = lines.slice(lines.indexOf('  ' + name + ':') + 1).filter((line) => line.startsWith('    ')).map((line) => line.slice(2));
  return { id, text: put(text, ['tasks', id], task, ['\n' + body.join('\n')]) };
}

export function addConnection(text: string, from: string, to: string): string {
  return add(text, ['connections'], from + ' -> ' + to);
}

/** The connection at that place of the list. */
export function removeConnection(text: string, index: number): string {
  return remove(text, ['connections', index]);
}

/** Where deployments name the task. */
function placementsOf(text: string, id: string): (string | number)[][] {
  const deployments = nodeAt(parsed(text), ['deployments']);
  const found: (string | number)[][] = [];
  for (const pair of isMap(deployments) ? deployments.items : []) {
    const tasks = isMap(pair.value) ? pair.value.get('tasks') : null;
    const index = isSeq(tasks) ? tasks.items.findIndex((item) => isScalar(item) && item.value === id) : -1;
    if (index >= 0) found.push(['deployments', String(isScalar(pair.key) ? pair.key.value : pair.key), 'tasks', index]);
  }
  return found;
}

const ownerOf = (port: string) => port.slice(0, port.lastIndexOf('.'));

/** Removes the task with its connections and its place in a process. */
export function removeTask(text: string, id: string): string {
  let left = text;
  const connections = networkIn(text)?.connections ?? [];
  for (let index = connections.length - 1; index >= 0; --index) {
    const connection = connections[index];
    if (connection && (ownerOf(connection.from) === id || ownerOf(connection.to) === id)) left = removeConnection(left, index);
  }
  for (const place of placementsOf(left, id)) left = remove(left, place);
  return remove(left, ['tasks', id]);
}

/**
 * Renames the task in its connections and its place in a process too. Throws where there is a task of that name, or it
 * is not a name.
 */
export function renameTask(text: string, id: string, name: string): string {
  if (name === id) return text;
  if (!/^[A-Za-z0-9_][A-Za-z0-9_:-]*$/.test(name)) throw new Error('a task is named by letters, digits, _, - and :');
  if (networkIn(text)?.tasks.some((task) => task.id === name)) throw new Error('there is a task ' + name + ' already');
  let left = rename(text, ['tasks', id], name);
  const list = record(parsed(text).toJS())['connections'];
  const renamed = (port: string) => (ownerOf(port) === id ? name + port.slice(port.lastIndexOf('.')) : port);
  networkIn(text)?.connections.forEach((connection, index) => {
    if (!connection || (ownerOf(connection.from) !== id && ownerOf(connection.to) !== id)) return;
    const [from, to] = [renamed(connection.from), renamed(connection.to)];
    if (typeof (list as unknown[])[index] === 'string') left = put(left, ['connections', index], from + ' -> ' + to);
    else left = put(put(left, ['connections', index, 'from'], from), ['connections', index, 'to'], to);
  });
  for (const place of placementsOf(left, id)) left = put(left, place, name);
  return left;
}

/** `yaml` is the value as it is typed. */
export function setProperty(text: string, task: string, name: string, yaml: string): string {
  const typed = yaml.trim();
  return put(text, ['tasks', task, 'properties', name], parse(yaml), typed.includes('\n') ? [] : [typed]);
}

/** Its component's default counts again. */
export function removeProperty(text: string, task: string, name: string): string {
  const only = Object.keys(networkIn(text)?.tasks.find((one) => one.id === task)?.properties ?? {}).length === 1;
  return remove(text, ['tasks', task, 'properties', ...(only ? [] : [name])]);
}
