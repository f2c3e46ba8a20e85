// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { elkGraph, endsAtGroups, isHidden } from './elk_graph';

const style = { direction: 'RIGHT', wraps: true, labels: true } as const;
const edge = (source: string, target: string, labelWidth?: number) => ({ id: source + target, source, target, labelWidth });

it('what is not connected is laid out beside, and packed', () => {
  const roots = [{ id: 'p', children: [{ id: 'a' }, { id: 'x' }, { id: 'y' }, { id: 'z' }] }, { id: 'q', children: [{ id: 'b' }] }, { id: 'c' }];
  const [together, alone] = elkGraph({ roots, edges: [edge('a', 'b')] }, style).children ?? [];
  expect(together?.children?.map((box) => box.id)).toEqual(['p', 'q']);
  expect(together?.layoutOptions?.['elk.hierarchyHandling']).toBe('INCLUDE_CHILDREN');
  const inside = together?.children?.[0]?.children ?? [];
  expect(inside[0]?.id).toBe('a');
  expect(inside[1] && isHidden(inside[1]) && inside[1].children?.map((box) => box.id)).toEqual(['x', 'y', 'z']);
  expect(alone?.children?.map((box) => box.id)).toEqual(['c']);
});

it('boxes come from the first one on, along the edges', () => {
  const roots = [{ id: 'end' }, { id: 'middle' }, { id: 'start', first: true }];
  const graph = elkGraph({ roots, edges: [edge('start', 'middle', 60), edge('middle', 'end'), edge('end', 'start')] }, style);
  expect(graph.children?.[0]?.children?.map((box) => box.id)).toEqual(['start', 'middle', 'end']);
  expect(graph.edges?.map((one) => one.labels?.[0]?.width)).toEqual([60, undefined, undefined]);
});

it('knows edges that end at groups', () => {
  const roots = [{ id: 'p', children: [{ id: 'a' }] }, { id: 'b' }];
  expect(endsAtGroups({ roots, edges: [edge('a', 'b')] })).toBe(false);
  expect(endsAtGroups({ roots, edges: [edge('b', 'p')] })).toBe(true);
});
