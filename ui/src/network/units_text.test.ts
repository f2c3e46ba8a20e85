// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';
import { unitsText } from './units_text';

test('units have their names and counts', () => {
  expect(unitsText({ units: { screws: { name: 'screws', count: 40 }, cups: { name: 'cups', count: 0 } } })).toBe('cups 0, screws 40');
});

test('a robot that keeps none, or is not known, has nothing to say', () => {
  expect([unitsText(undefined), unitsText({ units: {} }), unitsText(null)]).toEqual(['', '', '']);
});
