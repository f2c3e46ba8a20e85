// SPDX-License-Identifier: Apache-2.0
import { isAlias, isMap, isPair, isScalar, isSeq, parse, parseDocument, stringify, type Document, type Pair, type YAMLMap, type YAMLSeq } from 'yaml';

/**
 * Edits of a network's text, each from text to text. They touch only what they change, so that comments, order and
 * formatting of the rest stay. Each is checked against the same edit of the parsed document; where cutting and
 * pasting would not come to the same, the document is written anew, with its comments. They throw an Error where
 * the text cannot be parsed or a part is written in a way that cannot be edited so.
 */

export interface NetworkTask {
  id: string;
  component: string;
  /** By name, as values. */
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
  /** As in the file; null for what is not written as two ports. */
  connections: (NetworkConnection | null)[];
  /** Whether the functions below understand it: Rock's files they do not. */
  editable: boolean;
}

type Collection = YAMLMap | YAMLSeq;
type Item = Pair | { range?: [number, number, number] | null };

function parsed(text: string): Document.Parsed {
  const document = parseDocument(text);
  const problem = document.errors[0];
  if (problem) throw new Error('the text cannot be parsed: ' + (problem.message.split('\n')[0] ?? ''));
  return document as Document.Parsed;
}

function record(value: unknown): Record<string, unknown> {
  return typeof value === 'object' && value !== null && !Array.isArray(value) ? (value as Record<string, unknown>) : {};
}

function startOf(item: unknown): number {
  const node = isPair(item) ? item.key : item;
  return (node as { range?: [number, number, number] | null })?.range?.[0] ?? 0;
}

/** Where the text of an item ends, without comments and blank lines behind it. */
function endOf(item: unknown): number {
  if (isPair(item)) {
    const value = item.value as { range?: [number, number, number] } | null;
    return value?.range ? endOf(value) : ((item.key as { range: [number, number, number] }).range[1]);
  }
  if ((isMap(item) || isSeq(item)) && !item.flow && item.items.length > 0) return endOf(item.items[item.items.length - 1]);
  return (item as { range?: [number, number, number] | null })?.range?.[1] ?? 0;
}

const lineStart = (text: string, at: number) => text.lastIndexOf('\n', at - 1) + 1;
function lineEnd(text: string, at: number): number {
  const found = text.indexOf('\n', at);
  return found < 0 ? text.length : found;
}
/** Behind the line in which an item ends. */
function behind(text: string, item: unknown): number {
  const end = endOf(item);
  return end > 0 && text[end - 1] === '\n' ? end : Math.min(lineEnd(text, end) + 1, text.length);
}
const splice = (text: string, from: number, to: number, insert: string) => text.slice(0, from) + insert + text.slice(to);

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

/** What is drawn of a network; null where the text is none or cannot be parsed. */
export function networkIn(text: string): NetworkText | null {
  const document = parseDocument(text);
  if (document.errors.length > 0 || !isMap(document.contents)) return null;
  let root: Record<string, unknown>;
  try {
    root = record(document.toJS());
  } catch {
    return null;
  }
  if (!('tasks' in root) && !('network' in root)) return null;
  const places = placesOf(root);
  const taskNodes = document.get('tasks');
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

/** `attempts` in order, as far as they come to the same as `change`; else the document as it is written anew. */
function edited(text: string, change: (document: Document.Parsed) => void, attempts: ((document: Document.Parsed) => string | null)[]): string {
  const changed = parsed(text);
  change(changed);
  const wanted = JSON.stringify(changed.toJS());
  for (const attempt of attempts) {
    const found = attempt(parsed(text));
    if (found === null) continue;
    const again = parseDocument(found);
    if (again.errors.length > 0) continue;
    try {
      if (JSON.stringify(again.toJS()) === wanted) return found;
    } catch {
      // an alias that leads nowhere: the next attempt
    }
  }
  return changed.toString({ lineWidth: 0, flowCollectionPadding: false });
}

/** Puts an item behind the last one. */
function append(text: string, collection: Collection, item: string): string | null {
  const last: unknown = collection.items[collection.items.length - 1];
  const range = collection.range;
  if (!range) return null;
  if (collection.flow || last === undefined) {
    const [open, close] = isMap(collection) ? '{}' : '[]';
    if (last === undefined) return splice(text, range[0], range[1], (open ?? '') + item + (close ?? ''));
    return splice(text, endOf(last), endOf(last), ', ' + item);
  }
  const indent = ' '.repeat(range[0] - lineStart(text, range[0]));
  const place = behind(text, last);
  const line = indent + (isSeq(collection) ? '- ' : '') + item + '\n';
  return splice(text, place, place, place > 0 && text[place - 1] !== '\n' ? '\n' + line.trimEnd() : line);
}

/** A new entry of the whole document, with one item. */
function appendSection(text: string, document: Document.Parsed, key: string, item: string): string | null {
  const root = document.contents;
  if (!isMap(root) || root.flow) return null;
  const pair = root.items.find((one) => isScalar(one.key) && one.key.value === key);
  if (!pair) {
    return text + (text === '' || text.endsWith('\n') ? '' : '\n') + key + ':\n  ' + item + '\n';
  }
  const value: unknown = pair.value;
  const empty = value === null || (isScalar(value) && value.value === null) || ((isMap(value) || isSeq(value)) && value.items.length === 0);
  if (!empty) return null;
  const colon = text.indexOf(':', (pair.key as { range: [number, number, number] }).range[1]);
  const end = lineEnd(text, colon);
  const rest = text.slice(colon + 1, end).replace(/^[ \t]*(\{\s*\}|\[\s*\]|null|~)/, '').trimEnd();
  return text.slice(0, colon + 1) + rest + '\n  ' + item + text.slice(end);
}

/** Takes an item out; a collection that becomes empty stays as {} or []. */
function without(text: string, holder: Pair | null, collection: Collection, index: number): string | null {
  const items = collection.items as Item[];
  const item = items[index];
  if (!item) return null;
  if (collection.flow) {
    const next = items[index + 1];
    if (index > 0) return splice(text, endOf(items[index - 1]), endOf(item), '');
    return splice(text, startOf(item), next ? startOf(next) : endOf(item), '');
  }
  const begin = lineStart(text, startOf(item));
  const before = text.slice(begin, startOf(item));
  if (!(isSeq(collection) ? /^\s*-\s+$/ : /^\s*$/).test(before)) return null;
  const cut = splice(text, begin, behind(text, item), '');
  if (items.length > 1) return cut;
  if (!holder) return null;
  const colon = text.indexOf(':', (holder.key as { range: [number, number, number] }).range[1]);
  return splice(cut, colon + 1, colon + 1, isMap(collection) ? ' {}' : ' []');
}

function pairIn(map: unknown, key: string): Pair | null {
  return isMap(map) ? (map.items.find((pair) => isScalar(pair.key) && String(pair.key.value) === key) ?? null) : null;
}
function sectionIn(document: Document.Parsed, key: string): Pair | null {
  return pairIn(document.contents, key);
}

const quoted = (text: string) => JSON.stringify(text);
const inFlow = (value: unknown) => stringify(value, { collectionStyle: 'flow', lineWidth: 0, flowCollectionPadding: false, defaultStringType: 'PLAIN' }).trimEnd();

export function addTask(text: string, id: string, component: string): string {
  const item = inFlow(id) + ': {component: ' + quoted(component) + '}';
  if (networkIn(text)?.tasks.some((task) => task.id === id)) throw new Error('there is a task ' + id + ' already');
  return edited(
    text,
    (document) => {
      if (!isMap(document.get('tasks'))) document.set('tasks', document.createNode({}));
      document.setIn(['tasks', id], document.createNode({ component }));
    },
    [
      (document) => appendSection(text, document, 'tasks', item),
      (document) => {
        const tasks = document.get('tasks');
        return isMap(tasks) ? append(text, tasks, item) : null;
      },
    ],
  );
}

export function addConnection(text: string, from: string, to: string): string {
  const item = from + ' -> ' + to;
  return edited(
    text,
    (document) => {
      if (!isSeq(document.get('connections'))) document.set('connections', document.createNode([]));
      document.addIn(['connections'], item);
    },
    [
      (document) => appendSection(text, document, 'connections', '- ' + item),
      (document) => {
        const list = document.get('connections');
        return isSeq(list) ? append(text, list, item) : null;
      },
    ],
  );
}

/** The connection at that place of the list. */
export function removeConnection(text: string, index: number): string {
  return edited(text, (document) => void document.deleteIn(['connections', index]), [
    (document) => {
      const list = document.get('connections');
      return isSeq(list) ? without(text, sectionIn(document, 'connections'), list, index) : null;
    },
  ]);
}

function removePlacements(text: string, id: string): string {
  const deployments: unknown = parsed(text).get('deployments');
  for (const pair of isMap(deployments) ? deployments.items : []) {
    const key = isScalar(pair.key) ? pair.key.value : pair.key;
    const tasks = isMap(pair.value) ? pair.value.get('tasks') : null;
    if (!isSeq(tasks)) continue;
    const index = tasks.items.findIndex((item) => isScalar(item) && item.value === id);
    if (index < 0) continue;
    return edited(text, (document) => void document.deleteIn(['deployments', key, 'tasks', index]), [
      (document) => {
        const holder = pairIn(document.getIn(['deployments', key]), 'tasks');
        return holder && isSeq(holder.value) ? without(text, holder, holder.value, index) : null;
      },
    ]);
  }
  return text;
}

/** With its connections and its place in a process. */
export function removeTask(text: string, id: string): string {
  const owns = (port: string) => port.slice(0, port.lastIndexOf('.')) === id;
  let left = text;
  const connections = networkIn(text)?.connections ?? [];
  for (let index = connections.length - 1; index >= 0; --index) {
    const connection = connections[index];
    if (connection && (owns(connection.from) || owns(connection.to))) left = removeConnection(left, index);
  }
  left = removePlacements(left, id);
  const current = left;
  return edited(current, (document) => void document.deleteIn(['tasks', id]), [
    (document) => {
      const tasks = document.get('tasks');
      if (!isMap(tasks)) return null;
      return without(current, sectionIn(document, 'tasks'), tasks, tasks.items.findIndex((pair) => isScalar(pair.key) && String(pair.key.value) === id));
    },
  ]);
}

/** `yaml` is the value as it is typed. */
export function setProperty(text: string, task: string, name: string, yaml: string): string {
  const value: unknown = parse(yaml);
  const written = [...new Set([yaml.trim(), inFlow(value), JSON.stringify(value)])].filter((form) => !form.includes('\n'));
  return edited(
    text,
    (document) => {
      if (isAlias(document.getIn(['tasks', task])) || isAlias(document.getIn(['tasks', task, 'properties'], true)))
        throw new Error('the properties of ' + task + ' are written as an alias; edit the text');
      if (!isMap(document.getIn(['tasks', task, 'properties']))) document.setIn(['tasks', task, 'properties'], document.createNode({}));
      document.setIn(['tasks', task, 'properties', name], document.createNode(value));
    },
    written.map((form) => (document) => {
      const entry = document.getIn(['tasks', task]);
      const properties = isMap(entry) ? entry.get('properties', true) : null;
      if (isMap(properties)) {
        const old: unknown = pairIn(properties, name)?.value;
        if (!old) return append(text, properties, inFlow(name) + ': ' + form);
        const end = endOf(old);
        return splice(text, startOf(old), text[end - 1] === '\n' ? end - 1 : end, form);
      }
      return isMap(entry) ? append(text, entry, 'properties: {' + inFlow(name) + ': ' + form + '}') : null;
    }),
  );
}

/** Its component's default counts again. */
export function removeProperty(text: string, task: string, name: string): string {
  const only = Object.keys(networkIn(text)?.tasks.find((one) => one.id === task)?.properties ?? {}).length === 1;
  const path = only ? ['tasks', task] : ['tasks', task, 'properties'];
  const key = only ? 'properties' : name;
  return edited(text, (document) => void document.deleteIn([...path, key]), [
    (document) => {
      const map = document.getIn(path);
      if (!isMap(map)) return null;
      return without(text, null, map, map.items.findIndex((pair) => isScalar(pair.key) && String(pair.key.value) === key));
    },
  ]);
}

/** What differs, as one replacement. */
export function changeBetween(before: string, after: string): { from: number; to: number; insert: string } {
  let from = 0;
  while (from < before.length && from < after.length && before[from] === after[from]) from++;
  let same = 0;
  while (same < before.length - from && same < after.length - from && before[before.length - 1 - same] === after[after.length - 1 - same]) same++;
  return { from, to: before.length - same, insert: after.slice(from, after.length - same) };
}
