// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { applyChange } from './change';

describe('applyChange', () => {
  it('sets, removes and goes inside', () => {
    const before = { a: 1, b: { x: 1, y: 2 }, c: { z: 1 } };
    const after = applyChange(before, { set: { d: [1] }, remove: ['a'], in: { b: { set: { x: 3 }, remove: ['y'] } } });
    expect(after).toEqual({ b: { x: 3 }, c: { z: 1 }, d: [1] });
    expect(before).toEqual({ a: 1, b: { x: 1, y: 2 }, c: { z: 1 } });
    expect(after['c']).toBe(before.c);
  });
  it('tells null from nothing', () => {
    expect(applyChange({ a: 1 }, { set: { a: null } })).toEqual({ a: null });
  });
  it('takes names that objects have for ordinary ones', () => {
    const after = applyChange({}, { set: JSON.parse('{"__proto__": {"x": 1}, "constructor": 2}') });
    expect(Object.keys(after).sort()).toEqual(['__proto__', 'constructor']);
    expect(({} as { x?: number }).x).toBeUndefined();
  });
});
