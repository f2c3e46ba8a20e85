// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { connectionsOf, describeConnection } from './connections';
import { connection, status, task } from './testing';

describe('connections of a task', () => {
  it('are those to it and from it', () => {
    const shown = status([task('a'), task('b')], [connection('a.x', 'b.y'), connection('b.x', 'a.y'), connection('b.x', 'b.y'), connection('c.x', 'd.y')]);
    expect(connectionsOf(shown, 'a').map(([key]) => key)).toEqual(['b.x a.y', 'a.x b.y']);
    expect(connectionsOf(shown, 'b').map(([key]) => key)).toEqual(['a.x b.y', 'b.x b.y', 'b.x a.y']);
  });
  it('are described', () => {
    const quiet = connection('a.x', 'b.y');
    expect(describeConnection(quiet, undefined)).toBe('data; 0 written, 0 read, 0 dropped');
    const busy = { ...quiet, policy: 'buffer', size: 8, written: 100, read: 98, dropped: 2, measured: 9, latency_us: 2, latency_worst_us: 4000 };
    expect(describeConnection(busy, { rate: 50, latency: 3.125 })).toBe(
      'buffer of 8, 50/s, latency 3.13 µs, 4 ms at the most; 100 written, 98 read, 2 dropped',
    );
  });
});
