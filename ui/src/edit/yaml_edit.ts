// SPDX-License-Identifier: Apache-2.0
import { isAlias, isMap, isPair, isScalar, isSeq, parseDocument, stringify, visit, type Document, type Pair, type YAMLMap, type YAMLSeq } from 'yaml';

/**
 * Edits of a text in YAML, each from text to text. They touch only what they change, so that comments, order and
 * formatting of the rest stay. Each is checked against the same edit of the parsed document; where cutting and
 * pasting would not come to the same, the document is written anew, with its comments. They throw an Error where
 * the text cannot be parsed or a part is written in a way that cannot be edited so.
 */

/** Keys of maps and positions in lists, from the root. */
export type Path = readonly (string | number)[];

type Collection = YAMLMap | YAMLSeq;
type Item = Pair | { range?: [number, number, number] | null };
type Attempt = (document: Document.Parsed) => string | null;

/** The document, and what is wrong with it. The parser's own search for keys that occur twice takes quadratic time. */
function reading(text: string): { document: Document.Parsed; problem: string | null } {
  const document = parseDocument(text, { uniqueKeys: false });
  let problem = document.errors[0]?.message.split('\n')[0] ?? null;
  if (problem === null) {
    visit(document, {
      Map: (_, map) => {
        const keys = new Set(map.items.map((pair) => keyText(pair.key)));
        if (keys.size === map.items.length) return undefined;
        problem = 'a key occurs twice in one map';
        return visit.BREAK;
      },
    });
  }
  return { document: document as Document.Parsed, problem };
}
/** null where it cannot be parsed. */
export function documentIn(text: string): Document.Parsed | null {
  const { document, problem } = reading(text);
  return problem === null ? document : null;
}
export function parsed(text: string): Document.Parsed {
  const { document, problem } = reading(text);
  if (problem !== null) throw new Error('the text cannot be parsed: ' + problem);
  return document;
}

/** The value where it is a map, else an empty one. */
export function record(value: unknown): Record<string, unknown> {
  return typeof value === 'object' && value !== null && !Array.isArray(value) ? (value as Record<string, unknown>) : {};
}

/** The value on one line, as it can stand in [] or {}. */
export const inFlow = (value: unknown) => stringify(value, { collectionStyle: 'flow', lineWidth: 0, flowCollectionPadding: false, defaultStringType: 'PLAIN' }).trimEnd();

export function startOf(item: unknown): number {
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

const lineStart = (text: string, at: number) => (at === 0 ? 0 : text.lastIndexOf('\n', at - 1) + 1);
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
const columnOf = (text: string, at: number) => at - lineStart(text, at);
const indented = (item: string, indent: number) => item.replace(/\n(?=[^\n])/g, '\n' + ' '.repeat(indent));
const keyText = (key: unknown) => String(isScalar(key) ? key.value : key);
const isNothing = (value: unknown) => value === null || value === undefined || (isScalar(value) && value.value === null);
const isEmpty = (value: unknown) => isNothing(value) || ((isMap(value) || isSeq(value)) && value.items.length === 0);

/** `attempts` in order, as far as they come to the same as `change`; else the document as it is written anew. */
export function edited(text: string, change: (document: Document.Parsed) => void, attempts: Attempt[]): string {
  const document = parsed(text);
  const found = attempts.map((attempt) => attempt(document));
  change(document);
  const wanted = JSON.stringify(document.toJS());
  for (const one of new Set(found)) {
    if (one === null) continue;
    const again = documentIn(one);
    if (!again) continue;
    try {
      if (JSON.stringify(again.toJS()) === wanted) return one;
    } catch {
      // an alias that leads nowhere: the next attempt
    }
  }
  return document.toString({ lineWidth: 0, flowCollectionPadding: false });
}

function indexIn(collection: unknown, step: string | number): number {
  if (isSeq(collection)) return typeof step === 'number' && step < collection.items.length ? step : -1;
  return isMap(collection) ? collection.items.findIndex((pair) => keyText(pair.key) === String(step)) : -1;
}
function valueIn(collection: unknown, index: number): unknown {
  return isMap(collection) ? collection.items[index]?.value : isSeq(collection) ? collection.items[index] : undefined;
}

/** The node at the path; undefined where there is none. */
export function nodeAt(document: Document, path: Path): unknown {
  let node: unknown = document.contents;
  for (const step of path) {
    const index = indexIn(node, step);
    if (index < 0) return undefined;
    node = valueIn(node, index);
  }
  return node;
}
export function pairAt(document: Document, path: Path): Pair | null {
  const map = nodeAt(document, path.slice(0, -1));
  const index = indexIn(map, path[path.length - 1] ?? '');
  return isMap(map) && index >= 0 ? (map.items[index] ?? null) : null;
}

/** The collection at the path; `missing` and maps around it where there is nothing yet. */
function collectionAt(document: Document, path: Path, missing: object): Collection {
  if (isNothing(document.contents)) document.contents = document.createNode({}) as never;
  let node: unknown = document.contents;
  const refuse = (depth: number): never => {
    throw new Error((path.slice(0, depth).join(' / ') || 'the text') + (isAlias(node) ? ' is written as an alias' : ' is not written as a map or list') + '; edit the text');
  };
  path.forEach((step, depth) => {
    if (!isMap(node) && !isSeq(node)) refuse(depth);
    const index = indexIn(node, step);
    let next = valueIn(node, index);
    if (isNothing(next) && isMap(node)) {
      next = document.createNode(depth === path.length - 1 ? missing : {});
      if (index >= 0) (node.items[index] as Pair).value = next;
      else node.items.push(document.createPair(step, next) as never);
    }
    node = next;
  });
  return isMap(node) || isSeq(node) ? node : refuse(path.length);
}

/** Puts an item behind the last one, or before the one at `before`. */
function insert(text: string, collection: Collection, item: string, before = collection.items.length): string | null {
  const items = collection.items as Item[];
  const next = items[before];
  const last = items[items.length - 1];
  const range = collection.range;
  if (!range) return null;
  if (collection.flow || last === undefined) {
    if (item.includes('\n')) return null;
    const [open, close] = isMap(collection) ? '{}' : '[]';
    if (last === undefined) return splice(text, range[0], range[1], (open ?? '') + item + (close ?? ''));
    return next ? splice(text, startOf(next), startOf(next), item + ', ') : splice(text, endOf(last), endOf(last), ', ' + item);
  }
  const column = columnOf(text, range[0]);
  const line = ' '.repeat(column) + (isSeq(collection) ? '- ' : '') + indented(item, column) + '\n';
  const place = next ? beginOf(text, next) : behind(text, last);
  return splice(text, place, place, place > 0 && text[place - 1] !== '\n' ? '\n' + line.trimEnd() : line);
}

/** Where the lines of an item of a block begin, with the comments right above it. */
function beginOf(text: string, item: Item): number {
  let begin = lineStart(text, startOf(item));
  const indent = text.slice(begin, startOf(item)).replace(/\S/g, ' ');
  while (begin > 0) {
    const above = lineStart(text, begin - 1);
    if (!text.startsWith(indent + '#', above)) break;
    begin = above;
  }
  return begin;
}

/** The first item of what is empty under a key of a block, on a line of its own. */
function fill(text: string, pair: Pair, item: string, list: boolean): string | null {
  if (!isEmpty(pair.value)) return null;
  const column = columnOf(text, startOf(pair)) + 2;
  const colon = text.indexOf(':', (pair.key as { range: [number, number, number] }).range[1]);
  const end = lineEnd(text, colon);
  const rest = text.slice(colon + 1, end).replace(/^[ \t]*(\{\s*\}|\[\s*\]|null|~)/, '').trimEnd();
  return text.slice(0, colon + 1) + rest + '\n' + ' '.repeat(column) + (list ? '- ' : '') + indented(item, column) + text.slice(end);
}

/** A new entry of the collection at `path`, which need not be there yet. */
function insertAt(text: string, document: Document, path: Path, list: boolean, item: string, before?: number): string | null {
  let around: unknown = document.contents;
  let pair: Pair | null = null;
  for (let depth = 0; depth < path.length; ++depth) {
    const index = indexIn(around, path[depth] ?? '');
    const holder = around;
    if (index < 0) return isMap(holder) ? withNew(text, document, holder, path.slice(depth), list, item) : null;
    pair = isMap(holder) ? (holder.items[index] as Pair) : null;
    around = valueIn(holder, index);
    if (isEmpty(around)) {
      const inner = depth === path.length - 1 ? item : inFlow(path[depth + 1]) + ': ' + nested(path.slice(depth + 2), list, item);
      if (pair && isMap(holder) && !holder.flow) return fill(text, pair, inner, list && depth === path.length - 1);
      return isMap(around) || isSeq(around) ? insert(text, around, inner) : null;
    }
  }
  return isMap(around) || isSeq(around) ? insert(text, around, item, before) : null;
}
function nested(path: Path, list: boolean, item: string): string {
  const inner = path.length === 0 ? item : inFlow(path[0]) + ': ' + nested(path.slice(1), list, item);
  return list && path.length === 0 ? '[' + inner + ']' : '{' + inner + '}';
}
/** Sections of the whole document are blocks. */
function withNew(text: string, document: Document, map: YAMLMap, path: Path, list: boolean, item: string): string | null {
  const [key, ...rest] = path;
  if (map !== document.contents || map.flow) return insert(text, map, inFlow(key) + ': ' + nested(rest, list, item));
  const inner = rest.length === 0 ? (list ? '- ' : '') + indented(item, 2) : inFlow(rest[0]) + ': ' + nested(rest.slice(1), list, item);
  return text + (text === '' || text.endsWith('\n') ? '' : '\n') + inFlow(key) + ':\n  ' + inner + '\n';
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

function replaced(text: string, document: Document, path: Path, form: string): string | null {
  const old = nodeAt(document, path);
  if (!old) return null;
  if (isNothing(old) && startOf(old) === endOf(old)) {
    const pair = pairAt(document, path);
    if (!pair) return null;
    const colon = text.indexOf(':', (pair.key as { range: [number, number, number] }).range[1]);
    return splice(text, colon + 1, colon + 1, ' ' + form);
  }
  const end = endOf(old);
  return splice(text, startOf(old), text[end - 1] === '\n' ? end - 1 : end, form);
}

/** Sets what is at the path, with the maps around it; `written`: how, in order of preference. */
export function put(text: string, path: Path, value: unknown, written: string[] = []): string {
  const around = path.slice(0, -1);
  const key = path[path.length - 1] ?? '';
  const forms = [...new Set([...written, inFlow(value), JSON.stringify(value)])];
  return edited(
    text,
    (document) => {
      const collection = collectionAt(document, around, {});
      const index = indexIn(collection, key);
      const node = document.createNode(value);
      if (isSeq(collection)) collection.items[index] = node;
      else if (index >= 0) (collection.items[index] as Pair).value = node;
      else collection.items.push(document.createPair(key, node) as never);
    },
    forms.map((form) => (document) => {
      if (nodeAt(document, path) !== undefined) return form.includes('\n') ? null : replaced(text, document, path, form);
      return insertAt(text, document, around, false, inFlow(key) + ':' + (form.startsWith('\n') ? '' : ' ') + form);
    }),
  );
}

/** A new last item of the list at the path, which need not be there yet. */
export function add(text: string, path: Path, value: unknown): string {
  return edited(
    text,
    (document) => {
      const list = collectionAt(document, path, []);
      if (!isSeq(list)) throw new Error(path.join(' / ') + ' is not written as a list; edit the text');
      list.items.push(document.createNode(value));
    },
    [(document) => insertAt(text, document, path, true, inFlow(value)), (document) => insertAt(text, document, path, true, JSON.stringify(value))],
  );
}

/** Takes out the node at the path. A map or list that contained only that node stays empty, as {} or []. */
export function remove(text: string, path: Path): string {
  const around = path.slice(0, -1);
  const key = path[path.length - 1] ?? '';
  return edited(
    text,
    (document) => {
      const collection = nodeAt(document, around);
      const index = indexIn(collection, key);
      if ((isMap(collection) || isSeq(collection)) && index >= 0) collection.items.splice(index, 1);
    },
    [
      (document) => {
        const collection = nodeAt(document, around);
        return isMap(collection) || isSeq(collection) ? without(text, pairAt(document, around), collection, indexIn(collection, key)) : null;
      },
    ],
  );
}

/** Gives a key of a map another name, at the same place. */
export function rename(text: string, path: Path, name: string): string {
  return edited(
    text,
    (document) => {
      const pair = pairAt(document, path);
      if (!pair) throw new Error('there is no ' + path.join(' / '));
      if (pairAt(document, [...path.slice(0, -1), name])) throw new Error('there is a ' + name + ' already');
      pair.key = document.createNode(name);
    },
    [inFlow(name), JSON.stringify(name)].map((form) => (document) => {
      const pair = pairAt(document, path);
      return pair ? splice(text, startOf(pair), endOf(pair.key), form) : null;
    }),
  );
}

/** The lines of an entry of a block, with the comments right above it. */
function linesOf(text: string, collection: Collection, item: Item): { from: number; to: number; column: number } | null {
  if (collection.flow || text.slice(lineStart(text, startOf(item)), startOf(item)).trim() !== '') return null;
  return { from: beginOf(text, item), to: behind(text, item), column: columnOf(text, startOf(item)) };
}

/** The text with the entry moved to another place; its lines stay as they are, at another depth of indentation. */
function moved(text: string, document: Document, path: Path, target: Path, before: string | null): string | null {
  const from = nodeAt(document, path.slice(0, -1));
  const to = nodeAt(document, target);
  if (!isMap(from)) return null;
  const lines = linesOf(text, from, from.items[indexIn(from, path[path.length - 1] ?? '')] as Item);
  if (!lines) return null;
  const column = isEmpty(to) ? columnOf(text, startOf(pairAt(document, target))) + 2 : columnOf(text, (to as Collection).range?.[0] ?? 0);
  const block = text.slice(lines.from, lines.to).split('\n').map((line) => (line.trim() === '' ? line : ' '.repeat(column) + line.slice(Math.min(lines.column, /^ */.exec(line)?.[0].length ?? 0)))).join('\n');
  const item = block.endsWith('\n') ? block : block + '\n';
  const cut = without(text, pairAt(document, path.slice(0, -1)), from, indexIn(from, path[path.length - 1] ?? ''));
  if (cut === null) return null;
  // Comments above the entry go with it.
  const start = lineStart(text, startOf(from.items[indexIn(from, path[path.length - 1] ?? '')]));
  const comments = text.slice(lines.from, start);
  const shift = cut.length - (text.length - (lines.to - start)); // of " {}" where nothing is left
  const left = splice(cut, lines.from + shift, lines.from + shift + comments.length, '');
  const again = parseDocument(left);
  const place = nodeAt(again, target);
  if (isEmpty(place)) {
    const pair = pairAt(again, target);
    return pair ? fill(left, pair, item.trim().replace(new RegExp('\n {' + column + '}', 'g'), '\n'), false) : null;
  }
  if (!isMap(place) || place.flow) return null;
  const next = before === null ? undefined : (place.items[indexIn(place, before)] as Item | undefined);
  const at = next ? beginOf(left, next) : behind(left, place.items[place.items.length - 1]);
  return splice(left, at, at, at > 0 && left[at - 1] !== '\n' ? '\n' + item.trimEnd() : item);
}

/** Takes an entry of a map to the map at `target`, before the entry `before` of it, or behind the last one. */
export function move(text: string, path: Path, target: Path, before: string | null): string {
  const key = String(path[path.length - 1] ?? '');
  if (path.every((step, depth) => target[depth] === step)) throw new Error(key + ' cannot be moved into itself');
  const change = (document: Document) => {
    const from = nodeAt(document, path.slice(0, -1));
    const index = indexIn(from, key);
    if (!isMap(from) || index < 0) throw new Error('there is no ' + path.join(' / '));
    const [pair] = from.items.splice(index, 1);
    const to = collectionAt(document, target, {});
    if (!isMap(to)) throw new Error(target.join(' / ') + ' is not written as a map; edit the text');
    if (indexIn(to, key) >= 0) throw new Error('there is a ' + key + ' already');
    const place = before === null ? -1 : indexIn(to, before);
    to.items.splice(place < 0 ? to.items.length : place, 0, pair as never);
  };
  return edited(text, change, [
    (document) => moved(text, document, path, target, before),
    (document) => {
      // The pair is written on one line, which is possible only where it has no comments that would be lost.
      const pair = pairAt(document, path);
      if (!pair || text.slice(startOf(pair), endOf(pair)).includes('#')) return null;
      const item = inFlow(key) + ': ' + inFlow((pair.value as { toJS?: (of: Document) => unknown } | null)?.toJS?.(document) ?? null);
      const from = nodeAt(document, path.slice(0, -1)) as Collection;
      const left = without(text, pairAt(document, path.slice(0, -1)), from, indexIn(from, key));
      if (left === null) return null;
      const again = parseDocument(left);
      const to = nodeAt(again, target);
      return insertAt(left, again, target, false, item, before === null || indexIn(to, before) < 0 ? undefined : indexIn(to, before));
    },
  ]);
}

/** The difference, as one replacement. */
export function changeBetween(before: string, after: string): { from: number; to: number; insert: string } {
  let from = 0;
  while (from < before.length && from < after.length && before[from] === after[from]) from++;
  let same = 0;
  while (same < before.length - from && same < after.length - from && before[before.length - 1 - same] === after[after.length - 1 - same]) same++;
  return { from, to: before.length - same, insert: after.slice(from, after.length - same) };
}
