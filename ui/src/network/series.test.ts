// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { numbersIn, Series } from './series';

describe('series', () => {
  it('finds the numbers of a sample', () => {
    expect(numbersIn(3)).toEqual([['value', 3]]);
    expect(numbersIn({ a: { x: 1, t: 'no' }, b: [2, true], c: null })).toEqual([['a.x', 1], ['b[0]', 2], ['b[1]', 1]]);
    expect(numbersIn([1, 2, 3, 4], 2)).toHaveLength(2);
  });
  it('keeps the last seconds, columns of equal length', () => {
    const series = new Series(10);
    expect(series.add(0, { x: 1 })).toBe(true);
    expect(series.add(0, { x: 1 })).toBe(false);
    series.add(5, { y: 2 });
    series.add(12, { x: 3, y: 4 });
    expect(series.times).toEqual([5, 12]);
    expect([...series.columns]).toEqual([['x', [null, 3]], ['y', [2, 4]]]);
  });
});
