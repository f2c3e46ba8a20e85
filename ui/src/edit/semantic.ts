// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json, type JsonMap } from '../robot/change';

/** The semantic data of states of RAFCON: entries with texts, entries in them, or other values. */

/** One change of them (segue/rafcon/semantic_data.hpp). */
export interface SemanticEdit {
  /** Of the entry, the outermost first. */
  keys: string[];
  /** Missing: the entry is removed. */
  value?: Json;
}

export const nameOf = (keys: string[]) => keys.join(' › ');

/** The map with that entry, its own even where it is called __proto__. */
const withEntry = (map: JsonMap, key: string, value: Json): JsonMap => Object.fromEntries([...Object.entries(map).filter(([other]) => other !== key), [key, value]]);

function change(map: JsonMap, keys: string[], value: Json | undefined): JsonMap {
  const [key = '', ...inner] = keys;
  const old = Object.entries(map).find(([other]) => other === key)?.[1];
  if (inner.length > 0) return withEntry(map, key, change(isMap(old) ? old : {}, inner, value));
  return value === undefined ? Object.fromEntries(Object.entries(map).filter(([other]) => other !== key)) : withEntry(map, key, value);
}

/** The data after the edits; `data` itself stays as it is. */
export function applied(data: JsonMap, edits: SemanticEdit[]): JsonMap {
  return edits.reduce((map, { keys, value }) => change(map, keys, value), data);
}

/** In RAFCON's order. */
export function entriesIn(data: JsonMap): [string, Json][] {
  return Object.entries(data).sort(([a], [b]) => (a < b ? -1 : 1));
}

/** The keys of all entries that have entries, the whole first. */
export function groupsIn(data: JsonMap, around: string[] = []): string[][] {
  return [around, ...entriesIn(data).flatMap(([key, value]) => (isMap(value) ? groupsIn(value, [...around, key]) : []))];
}

/** An entry as it is typed; null: it is edited as entries of its own. */
export function typedOf(value: Json): string | null {
  if (typeof value === 'string') return value;
  return isMap(value) && Object.keys(value).length > 0 ? null : isMap(value) ? '' : JSON.stringify(value);
}

/** The value that was typed for an entry that had `before`: what was no text stays JSON. Throws where it is none. */
export function valueOf(typed: string, before: Json): Json {
  if (typeof before === 'string' || isMap(before)) return typed;
  try {
    return JSON.parse(typed) as Json;
  } catch {
    throw new Error('this entry is not a text but a value in JSON, such as 3, true or ["a", "b"]');
  }
}

/** Why an entry cannot be added; null: it can. */
export function refusalOf(data: JsonMap, around: string[], key: string): string | null {
  if (key === '') return 'an entry needs a key';
  let map: Json = data;
  for (const step of around) {
    const inner: Json | undefined = isMap(map) ? Object.entries(map).find(([other]) => other === step)?.[1] : undefined;
    map = inner ?? {};
  }
  return isMap(map) && Object.keys(map).includes(key) ? 'there is an entry ' + key + ' already' : null;
}

/** The entries that Segue reads, below "segue" (docs/missions.md). Texts are YAML. */
export const declarations: Record<string, string> = {
  preconditions: 'facts that must hold when it begins, such as !held({box})',
  effects: 'facts that come true when it ends as expected, such as ["+held({box})", "-at({box}, table)"]',
  resources: 'such as [{block: arm}]; of the root of the machine, such as {arm: {count: 2}}',
  world: 'of the root: facts that hold at first',
  pure: 'true: its result may be discarded',
  sensing: 'true: it observes reality and may be repeated',
  reads_world: 'true: it looks at facts that it does not declare',
  strict: 'true: it waits until nothing before it can fail',
  routine: 'true, of a container or a library: it is executed sequentially, as one action',
  expect: 'what is expected of it, such as {duration: 2s}',
  controllers: 'controllers that its script may request',
  run: 'what Segue does in place of its script',
  isolated: 'true: its script runs in a process of its own',
};
