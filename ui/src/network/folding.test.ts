// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { foldLevels, levelBehind } from './folding';

const sizes = (...levels: ReadonlySet<string>[]) => levels.map((level) => [...level].sort());

const processes = (...sizesOf: number[]) => sizesOf.map((size, index) => ({ id: 'p' + index, size, isInner: true }));
const hosts = (count: number) => Array.from({ length: count }, (_, index) => ({ id: 'h' + index, size: 10, isInner: false }));

it('large processes fold first, then all, then hosts', () => {
  expect(sizes(...foldLevels([...hosts(1), ...processes(1, 20, 2, 9, 1)], false))).toEqual([[], ['p1', 'p3'], ['p0', 'p1', 'p2', 'p3', 'p4']]);
  expect(foldLevels([...hosts(5), ...processes(1, 20, 2, 9, 1)], false).map((level) => level.size)).toEqual([0, 2, 5, 10]);
});

it('nothing folds to less than tells something', () => {
  expect(foldLevels(processes(20, 20), false)).toHaveLength(1);
});

it('what is known to be large begins folded', () => {
  expect(sizes(...foldLevels([{ id: 'p', size: 200, isInner: true }], true))).toEqual([['p']]);
  expect(sizes(...foldLevels([], true))).toEqual([[]]);
});

it('the next level folds something that does not stay open', () => {
  const levels = [[], ['a'], ['a', 'b'], ['a', 'b', 'c']].map((level) => new Set(level));
  const behind = (at: number, ...stays: string[]) => levelBehind(levels, at, (place) => stays.includes(place));
  expect([behind(0), behind(1), behind(3)]).toEqual([1, 2, null]);
  expect([behind(0, 'a'), behind(0, 'a', 'b'), behind(1, 'b', 'c')]).toEqual([2, 3, null]);
});
