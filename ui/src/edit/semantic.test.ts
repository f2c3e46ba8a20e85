// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { JsonMap } from '../robot/change';
import { applied, entriesIn, groupsIn, refusalOf, typedOf, valueOf } from './semantic';

const data: JsonMap = { RAFCONTPP: { types: 'Food', empty: {} }, count: 2 };

describe('semantic data', () => {
  it('are those of the file with the edits one after the other', () => {
    const edits = [{ keys: ['segue', 'effects'], value: '+a()' }, { keys: ['RAFCONTPP', 'types'], value: 'Food, Person' }, { keys: ['count'] }, { keys: ['segue', 'effects'], value: '+b()' }];
    expect(applied(data, edits)).toEqual({ RAFCONTPP: { types: 'Food, Person', empty: {} }, segue: { effects: '+b()' } });
    expect(data).toEqual({ RAFCONTPP: { types: 'Food', empty: {} }, count: 2 });
    expect(applied(data, [])).toBe(data);
  });
  it('have entries of any name', () => {
    const edited = applied({}, [{ keys: ['__proto__', 'constructor'], value: 'x' }]);
    expect(Object.keys(edited)).toEqual(['__proto__']);
    expect(groupsIn(edited)).toEqual([[], ['__proto__']]);
    expect(refusalOf(edited, ['__proto__'], 'constructor')).toContain('already');
    expect(refusalOf(edited, [], 'constructor')).toBeNull();
  });
  it('are shown in the order in which RAFCON writes them', () => {
    expect(entriesIn({ b: 1, a: 2, B: 3 }).map(([key]) => key)).toEqual(['B', 'a', 'b']);
    expect(groupsIn(data)).toEqual([[], ['RAFCONTPP'], ['RAFCONTPP', 'empty']]);
  });
  it('are texts where nothing else was', () => {
    expect(typedOf('a')).toBe('a');
    expect(typedOf({})).toBe('');
    expect(typedOf({ a: 1 })).toBeNull();
    expect(typedOf([1, 'b'])).toBe('[1,"b"]');
    expect(valueOf('7', 'text')).toBe('7');
    expect(valueOf('7', {})).toBe('7');
    expect(valueOf('7', 2)).toBe(7);
    expect(() => valueOf('seven', 2)).toThrow('not a text but a value in JSON');
  });
  it('have one entry of each name', () => {
    expect(refusalOf(data, [], '')).not.toBeNull();
    expect(refusalOf(data, ['RAFCONTPP'], 'types')).toContain('types');
    expect(refusalOf(data, ['segue'], 'types')).toBeNull();
  });
});
