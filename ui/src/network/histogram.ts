// SPDX-License-Identifier: Apache-2.0
import type { Histogram } from '../robot/types';
import { microsecondsText } from '../units';

export interface Bar {
  /** From 0 to 1, the highest bar: proportional to the logarithm of the count. */
  height: number;
  from: string;
  /** "" where the bin has no end. */
  below: string;
  count: number;
}

export function barsOf(histogram: Histogram): Bar[] {
  const most = Math.max(1, ...histogram.bins.map((bin) => bin.count));
  return histogram.bins.map(({ from_us, below_us, count }) => ({
    height: Math.log1p(count) / Math.log1p(most),
    from: microsecondsText(from_us),
    below: below_us === null ? '' : microsecondsText(below_us),
    count,
  }));
}

/** The content of the drawing, in words. */
export function summaryOf(histogram: Histogram): string {
  const total = histogram.bins.reduce((sum, bin) => sum + bin.count, 0);
  if (total === 0) return 'none yet';
  return `half within ${microsecondsText(histogram.p50_us)}, 99 % within ${microsecondsText(histogram.p99_us)}`;
}
