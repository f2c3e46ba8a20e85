// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { least, limited, sizeIn } from './sizes';

it('both panes keep a least size', () => {
  expect(limited(300, 1000)).toBe(300);
  expect(limited(10, 1000)).toBe(least);
  expect(limited(990, 1000)).toBe(1000 - least);
});

it('only sizes are taken from what is kept', () => {
  expect(sizeIn('250')).toBe(250);
  for (const text of [null, '', 'wide', '-3', '3']) expect(sizeIn(text)).toBe(null);
});
