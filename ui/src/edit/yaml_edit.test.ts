// SPDX-License-Identifier: Apache-2.0
import { parse } from 'yaml';
import { describe, expect, it } from 'vitest';
import { add, changeBetween, move, put, remove, rename, type Path } from './yaml_edit';

/** A source of pseudo-random numbers, which are the same for the same seed. */
function numbers(seed: number): (below: number) => number {
  let state = seed >>> 0;
  return (below) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * below);
  };
}

interface Written {
  lines: string[];
  value: unknown;
}

/** A map with comments as a block, or on one line. */
function writtenMap(next: (below: number) => number, depth: number, comment: () => string): Written {
  const value: Record<string, unknown> = {};
  const lines: string[] = [];
  for (let count = 1 + next(4), i = 0; i < count; ++i) {
    const key = ['a', 'b b', '"c: d"', 'e', '7', 'f-g'][next(6)] ?? 'a';
    const name = key.replace(/"/g, '');
    if (name in value) continue;
    if (next(3) === 0) lines.push(comment());
    if (next(5) === 0) lines.push('');
    const kind = depth > 0 ? next(6) : next(3);
    if (kind <= 1) {
      value[name] = next(100);
      lines.push(key + ':' + ' '.repeat(1 + next(2)) + String(value[name]) + (next(2) ? '   ' + comment() : ''));
    } else if (kind === 2) {
      value[name] = { x: 1, y: [1, 'two'] };
      lines.push(key + ': {x: 1, y: [1,  "two"]}' + (next(2) ? ' ' + comment() : ''));
    } else if (kind === 3) {
      value[name] = ['p', 'q'];
      lines.push(key + ':' + (next(2) ? ' ' + comment() : ''), '  - p ' + comment(), "  - 'q'");
    } else if (kind === 4) {
      value[name] = 'one\ntwo\n';
      lines.push(key + ': |', '  one', '  two');
    } else {
      const inner = writtenMap(next, depth - 1, comment);
      value[name] = inner.value;
      lines.push(key + ':' + (next(2) ? ' ' + comment() : ''), ...inner.lines.map((line) => (line === '' ? '' : '  ' + line)));
    }
  }
  return { lines, value };
}

type Any = Record<string, unknown>;
const isRecord = (value: unknown): value is Any => typeof value === 'object' && value !== null && !Array.isArray(value);
function pathsIn(value: unknown, path: Path = []): Path[] {
  if (!isRecord(value)) return [];
  return Object.keys(value).flatMap((key) => [[...path, key], ...pathsIn(value[key], [...path, key])]);
}
const at = (value: unknown, path: Path): unknown => path.reduce<unknown>((inner, step) => (inner as Any | undefined)?.[step], value);

/** One edit, of the text and of the value that it means. */
function step(next: (below: number) => number, text: string, value: Any): { text: string; value: Any; what: string; removed: boolean } {
  const wanted = structuredClone(value);
  const all = pathsIn(value);
  const path = all[next(all.length)] ?? ['a'];
  const around = at(wanted, path.slice(0, -1)) as Any;
  const key = String(path[path.length - 1]);
  const what = next(5);
  const name = 'new ' + next(1000);
  if (what === 0) {
    const fresh = [3, 'a, b', { k: [1] }, null, 'x # y'][next(5)];
    const target = next(2) ? path : [...path.slice(0, -1), name];
    around[String(target[target.length - 1])] = fresh;
    const found = put(text, target, fresh);
    return { text: found, value: wanted, what: 'put ' + target.join('/'), removed: target === path };
  }
  if (what === 1 && all.length > 1) {
    delete around[key];
    return { text: remove(text, path), value: wanted, what: 'remove ' + path.join('/'), removed: true };
  }
  if (what === 2) {
    const renamed = Object.fromEntries(Object.entries(around).map(([one, inner]) => [one === key ? name : one, inner]));
    for (const one of Object.keys(around)) delete around[one];
    Object.assign(around, renamed);
    return { text: rename(text, path, name), value: wanted, what: 'rename ' + path.join('/'), removed: false };
  }
  if (what === 3) {
    const list = all.find((one) => Array.isArray(at(value, one))) ?? [name];
    if (!Array.isArray(at(wanted, list))) wanted[name] = [];
    (at(wanted, list) as unknown[]).push(name + ': z');
    return { text: add(text, list, name + ': z'), value: wanted, what: 'add ' + list.join('/'), removed: false };
  }
  const targets = [[] as Path, ...all].filter((one) => isRecord(at(value, one)) && !path.every((part, depth) => one[depth] === part) && (one.length === path.length - 1 ? true : !(key in (at(value, one) as Any))));
  const target = targets[next(targets.length)] ?? [];
  const to = at(wanted, target) as Any;
  const moved = around[key];
  const isSame = to === around;
  if (!isSame && key in to) return { text, value: wanted, what: 'nothing', removed: false };
  delete around[key];
  const others = Object.keys(to);
  const before = others.length > 0 && next(2) ? (others[next(others.length)] ?? null) : null;
  const entries = Object.entries(to);
  const place = before === null ? entries.length : others.indexOf(before);
  entries.splice(place, 0, [key, moved]);
  for (const one of others) delete to[one];
  Object.assign(to, Object.fromEntries(entries));
  return { text: move(text, path, target, before), value: wanted, what: 'move ' + path.join('/') + ' to ' + target.join('/') + ' before ' + before, removed: false };
}

/** Keys that look like numbers are sorted by JavaScript; their order is compared as text elsewhere. */
const comments = (text: string) => [...text.matchAll(/# c\d+/g)].map((found) => found[0]);

describe('random edits', () => {
  it('come to the document that is meant, and keep comments', () => {
    for (let seed = 1; seed <= 25; ++seed) {
      const next = numbers(seed);
      let count = 0;
      const written = writtenMap(next, 3, () => '# c' + ++count);
      let text = written.lines.join('\n') + (next(4) ? '\n' : '');
      let value = written.value as Any;
      if (Object.keys(value).length === 0) continue;
      expect(parse(text), 'seed ' + seed).toEqual(value);
      for (let i = 0; i < 8 && pathsIn(value).length > 0; ++i) {
        const before = text;
        const done = step(next, text, value);
        const where = 'seed ' + seed + ', ' + done.what + ' of\n' + before + '\nto\n' + done.text;
        expect(parse(done.text), where).toEqual(done.value);
        if (!done.removed) expect(comments(done.text).sort(), where).toEqual(comments(before).sort());
        ({ text, value } = done);
      }
    }
  }, 100000);
});

describe('edits touch nothing else', () => {
  const text = 'top:\n  # about a\n  a:   # first\n    x: 1\n\n    y: |\n      one\n  b: {z: 2}\nend: {}   # nothing\n';
  it('moves lines as they stand', () => {
    expect(move(text, ['top', 'a'], ['end'], null)).toBe('top:\n  b: {z: 2}\nend:   # nothing\n  # about a\n  a:   # first\n    x: 1\n\n    y: |\n      one\n');
    expect(move(text, ['top', 'a'], ['top'], null)).toBe('top:\n  b: {z: 2}\n  # about a\n  a:   # first\n    x: 1\n\n    y: |\n      one\nend: {}   # nothing\n');
    expect(move(text, ['top', 'b'], ['top'], 'a')).toBe('top:\n  b: {z: 2}\n  # about a\n  a:   # first\n    x: 1\n\n    y: |\n      one\nend: {}   # nothing\n');
    expect(move(text, ['top', 'b'], [], null)).toBe('top:\n  # about a\n  a:   # first\n    x: 1\n\n    y: |\n      one\nend: {}   # nothing\nb: {z: 2}\n');
    expect(move(text, ['top', 'b', 'z'], ['top', 'a'], 'x')).toBe(text.replace('    x: 1\n', '    z: 2\n    x: 1\n').replace('{z: 2}', '{}'));
    expect(() => move(text, ['top'], ['top', 'a'], null)).toThrow('itself');
    expect(() => move(text, ['none'], ['top'], null)).toThrow('no none');
  });
  it('writes new sections as blocks, and the rest on one line', () => {
    expect(put('a: 1\n', ['on', 'x', 'y'], 'z')).toBe('a: 1\non:\n  x: {y: z}\n');
    expect(put(text, ['top', 'b', 'on', 'done'], 'a')).toBe(text.replace('{z: 2}', '{z: 2, on: {done: a}}'));
    expect(add('a: 1', ['list'], 'x -> y')).toBe('a: 1\nlist:\n  - x -> y\n');
    expect(add('', ['list'], 'x')).toBe('list:\n  - x\n');
  });
  it('refuses what stands elsewhere', () => {
    expect(() => put('a: &x {b: 1}\nc: *x\n', ['c', 'b'], 2)).toThrow('c is written as an alias');
    expect(() => put('a: 1\n', ['a', 'b'], 2)).toThrow('a is not written as a map');
    expect(() => rename('a: 1\nb: 2\n', ['a'], 'b')).toThrow('already');
    for (const broken of ['a: [', 'a: 1\na: 2\n', 'x: {a: 1, "a": 2}']) expect(() => put(broken, ['b'], 1)).toThrow('parsed');
  });
});

it('changeBetween is one replacement', () => {
  for (const [a, b] of [['abc', 'abxc'], ['aa', 'aaa'], ['', 'x'], ['same', 'same'], ['abab', 'ab']] as const) {
    const { from, to, insert } = changeBetween(a, b);
    expect(a.slice(0, from) + insert + a.slice(to)).toBe(b);
  }
});
