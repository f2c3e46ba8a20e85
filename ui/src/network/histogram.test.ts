// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { microsecondsText } from '../units';
import { barsOf, summaryOf } from './histogram';

const none = { p50_us: 0, p99_us: 0, bins: [] };
const some = {
  p50_us: 1.536,
  p99_us: 3072,
  bins: [
    { from_us: 0, below_us: 0.128, count: 1 },
    { from_us: 0.128, below_us: 0.192, count: 0 },
    { from_us: 17179869, below_us: null, count: 99 },
  ],
};

describe('histograms', () => {
  it('have durations of three digits', () => {
    expect([0, 0.128, 1.536, 196.608, 3072, 17179869].map(microsecondsText)).toEqual(['0 µs', '0.128 µs', '1.54 µs', '197 µs', '3.07 ms', '17.2 s']);
  });
  it('have bars whose heights follow the digits of the counts', () => {
    const bars = barsOf(some);
    expect(bars.map((bar) => bar.height)).toEqual([Math.log(2) / Math.log(100), 0, 1]);
    expect(bars.map((bar) => [bar.from, bar.below])).toEqual([['0 µs', '0.128 µs'], ['0.128 µs', '0.192 µs'], ['17.2 s', '']]);
    expect(barsOf(none)).toEqual([]);
  });
  it('are summed up in words', () => {
    expect(summaryOf(some)).toBe('half within 1.54 µs, 99 % within 3.07 ms');
    expect(summaryOf(none)).toBe('none yet');
  });
});
