// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';
import { haltText } from './halt';

const halt = { who: 'ann', why: '', time_s: 1, state: 'at_rest' };

test('says nothing of a robot that was not halted', () => {
  expect(haltText({ halt: null, stopped_by: null })).toBe('');
});

test('says who halted it, why, and whether it is at rest', () => {
  expect(haltText({ halt, stopped_by: null })).toBe('Halted by ann: at rest.');
  expect(haltText({ halt: { ...halt, why: 'a button', state: 'halting' }, stopped_by: null })).toBe('Halted by ann (a button): on its way to rest.');
});

test('names what had to be stopped, and that it is held', () => {
  const late = { ...halt, state: 'not_at_rest', trouble: 'wheels turn', stopped: ['wheels', 'arm'] };
  expect(haltText({ halt: late, stopped_by: 'ann' })).toBe(
    'Halted by ann: not at rest in time: wheels turn. Stopped, since they hold devices: wheels, arm. Whatever is requested is refused until it is released.',
  );
});
