// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { readable } from './boxes';
import { fitted } from './view';

const pane = { width: 1000, height: 500 };

it('a graph that fits stands in the middle', () => {
  const { x, y, zoom } = fitted({ width: 900, height: 100 }, pane, { x: 0, y: 0 });
  expect(zoom).toBeGreaterThan(1);
  expect(2 * x + 900 * zoom).toBeCloseTo(1000);
  expect(2 * y + 100 * zoom).toBeCloseTo(500);
});

it('a large graph is shown from its first box on, so that it can be read', () => {
  const size = { width: 5000, height: 400 };
  const beginning = fitted(size, pane, { x: 0, y: 0 });
  expect(beginning.zoom).toBe(readable);
  expect(beginning.x).toBeGreaterThanOrEqual(0);
  const far = fitted(size, pane, { x: 4800, y: 0 });
  expect(4800 * far.zoom + far.x).toBeGreaterThan(0);
  expect(5000 * far.zoom + far.x).toBeLessThanOrEqual(1000);
});
