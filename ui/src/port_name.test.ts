// SPDX-License-Identifier: Apache-2.0
import { createElement } from 'react';
import { renderToStaticMarkup } from 'react-dom/server';
import { expect, test } from 'vitest';
import { PortName } from './PortName';
import type { Direction } from './robot/types';

const markupOf = (name: string, direction: Direction) => renderToStaticMarkup(createElement(PortName, { name, direction }));
const seen = (markup: string) => markup.replace(/<span class="hidden">[^<]*<\/span>/, '').replace(/<[^>]*>/g, '');
const heard = (markup: string) => markup.replace(/<span aria-hidden="true">[^<]*<\/span>/, '').replace(/<[^>]*>/g, '');

test('data goes along the arrow: into an input, out of an output', () => {
  expect(seen(markupOf('scan', 'input'))).toBe('→ scan');
  expect(seen(markupOf('velocity', 'output'))).toBe('velocity →');
});

test('screen readers hear the direction in place of the arrow', () => {
  expect(heard(markupOf('scan', 'input'))).toBe('input scan');
  expect(heard(markupOf('velocity', 'output'))).toBe('output velocity');
});
