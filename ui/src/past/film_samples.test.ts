// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { filmOf, type PastTransition } from './film';
import { beginOf, isClock, valuesAt, windowOf, zoomedTo } from './film_samples';

const transition: PastTransition = {
  id: 1, from: 'a', to: 'b', runs: 'b', outcome: 'done', who: '', ended_s: 1800000010, lasted_s: 4, actions: [], undo_actions: [], before: null, after: null,
};

describe('the samples of a film', () => {
  it('are found by their own clock', () => {
    const clock = { now_s: 1800000100, studio_s: 500, within_s: 0.001 };
    expect(beginOf(filmOf(transition), clock)).toBe(406);
    expect(beginOf(filmOf({ ...transition, lasted_s: null }), clock)).toBe(410);
    expect(isClock(clock)).toBe(true);
    for (const other of [null, {}, { now_s: 1 }, { ...clock, within_s: 'x' }]) expect(isClock(other)).toBe(false);
  });

  it('have some from before and after it', () => {
    expect(windowOf(filmOf({ ...transition, lasted_s: 2 }))).toEqual([-1, 3]);
    expect(windowOf(filmOf({ ...transition, lasted_s: 40 }))).toEqual([-10, 50]);
  });

  it('have the values of the last samples until a time', () => {
    // Two ports with times of their own; the first one was interrupted.
    const drawn = { labels: ['a', 'b'], data: [[0, 1, 2, 3], [0, undefined, null, undefined], [undefined, 7, undefined, 8]] as [number[], ...(number | null | undefined)[][]] };
    expect([-1, 0, 1.5, 2.5, 9].map((at) => valuesAt(drawn, at))).toEqual([[null, null], [0, null], [0, 7], [null, 7], [null, 8]]);
  });

  it('are zoomed around the moment of the film', () => {
    const whole: [number, number] = [-1, 5];
    expect(zoomedTo(whole, 0.5, 2, whole)).toEqual([0.5, 3.5]);
    expect(zoomedTo([0, 1], 0.5, 4, whole)).toEqual([0.5, 1]);
    expect(zoomedTo([0.5, 3.5], 4, 2, whole)).toBe(null);
    expect(zoomedTo([-1, 0.5], 2, 0, whole)).toEqual([-1, 1]);
  });
});
