// SPDX-License-Identifier: Apache-2.0
import { createElement } from 'react';
import { renderToStaticMarkup } from 'react-dom/server';
import { expect, test } from 'vitest';
import { ActionButton } from './ActionButton';

const markupOf = (whyNot: string) => renderToStaticMarkup(createElement(ActionButton, { whyNot, type: 'submit', title: 'Adds it' }, 'add'));

test('a button that cannot be pressed says why, to eyes and screen readers', () => {
  const markup = markupOf('needs a name');
  const id = /aria-describedby="([^"]+)"/.exec(markup)?.[1];
  expect(id).toBeTruthy();
  expect(markup).toContain('<small id="' + id + '" class="why-not">needs a name</small>');
  expect(markup).toContain('aria-disabled="true"');
  expect(markup).not.toContain(' disabled');
});

test('a button that can be pressed has its title and no reason', () => {
  expect(markupOf('')).toBe('<span class="action"><button type="submit" title="Adds it">add</button></span>');
});
