// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';
import { durationText } from './units';

test('durations have three digits and the unit in which they are short', () => {
  expect([0, 0.0000012345, 0.0034, 0.25, 1.5, 84].map(durationText)).toEqual(['0 µs', '1.23 µs', '3.4 ms', '250 ms', '1.5 s', '84 s']);
  expect([0.0009996, 0.9996].map(durationText)).toEqual(['1 ms', '1 s']);
});
