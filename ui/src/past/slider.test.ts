// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { stepOf, timeInAddress, timeOf } from './slider';

describe('a slider over time', () => {
  it('reaches both ends from wherever a film was stopped', () => {
    const film = { first: 0, last: 4, steps: 200 };
    // Within half a step of the ends: one key further, the end is reached.
    expect(stepOf(film, 3.999)).toBe(199);
    expect(timeOf(film, stepOf(film, 3.999) + 1)).toBe(4);
    expect(stepOf(film, 0.001)).toBe(1);
    expect(timeOf(film, stepOf(film, 0.001) - 1)).toBe(0);
    expect(stepOf(film, 4)).toBe(200);
    expect(stepOf(film, 0)).toBe(0);
  });

  it('stays where it was moved to', () => {
    for (const [first, last] of [[0, 4], [0, 0.0123457], [0, 1 / 3], [1764100000.123, 1764186400.987]] as const) {
      const scale = { first, last, steps: 1000 };
      const steps = Array.from({ length: scale.steps + 1 }, (_, step) => step);
      expect(steps.map((step) => stepOf(scale, timeOf(scale, step)))).toEqual(steps);
    }
  });

  it('has one place where nothing lasts', () => {
    const nothing = { first: 7, last: 7, steps: 200 };
    expect([0, 100, 200].map((step) => timeOf(nothing, step))).toEqual([7, 7, 7]);
    expect(stepOf(nothing, 7)).toBe(200);
  });
});

describe('an address', () => {
  it('names a time, or none', () => {
    expect(timeInAddress('#past/1800000000.25')).toBe(1800000000.25);
    for (const other of ['#past', '#past/', '#past/now', '#missions/5', '#past/5/6', '#past/-5']) expect(timeInAddress(other), other).toBe(null);
  });
});
