// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { latencyOf, matching, rateOf, titleOf, toneOf } from './graph';
import { connection, status, task } from './testing';

describe('the network', () => {
  it('knows rates', () => {
    expect(rateOf(connection('a.x', 'b.y', 10), connection('a.x', 'b.y', 30), 2)).toBe(10);
    expect(rateOf(connection('a.x', 'b.y', 30), connection('a.x', 'b.y', 10), 2)).toBeNull();
    expect(rateOf(undefined, connection('a.x', 'b.y', 10), 2)).toBeNull();
    expect(rateOf(connection('a.x', 'b.y', 1), connection('a.x', 'b.y', 1), 0)).toBeNull();
  });
  it('knows latencies of late', () => {
    const measured = (count: number, latency_us: number) => ({ ...connection('a.x', 'b.y'), measured: count, latency_us });
    expect(latencyOf(undefined, measured(10, 4))).toBe(4);
    expect(latencyOf(measured(10, 4), measured(20, 6))).toBe(8);
    expect(latencyOf(measured(10, 4), measured(10, 4))).toBe(4);
    expect(latencyOf(measured(10, 4), measured(2, 7))).toBe(7); // made anew
    expect(latencyOf(measured(0, 0), measured(0, 0))).toBeNull();
    expect(latencyOf(undefined, connection('a.x', 'b.y'))).toBeNull();
  });
  it('names no computer where there is only the own one', () => {
    expect(['', 'localhost / sensors', 'base / sensors'].map(titleOf)).toEqual(['runtime', 'sensors', 'base / sensors']);
  });
  it('finds tasks by words and colours states', () => {
    expect(matching(status([task('drive'), task('laser', { state: 'exception' })]), 'EXC las')).toEqual(['laser']);
    expect([toneOf('running'), toneOf('exception'), toneOf('stopped')]).toEqual(['good', 'bad', 'idle']);
  });
});
