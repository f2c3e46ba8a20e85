// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { foldGroups } from './fold_groups';

const node = (id: string, group: string, detail: string) => ({ id, group, title: id, detail, look: 'fate-' + detail });
const picture = {
  groups: [{ id: 'p', title: 'p' }, { id: 'q', title: 'q' }],
  nodes: [node('a', 'p', 'unchanged'), node('b', 'p', 'unchanged'), node('c', 'p', 'added'), node('d', 'q', 'removed')],
  edges: [
    { id: 'ab', source: 'a', target: 'b', look: 'x' }, { id: 'ad', source: 'a', target: 'd', look: 'x' }, { id: 'bd', source: 'b', target: 'd', look: 'y' },
  ],
};

it('a folded group is one box with counts, and its edges are one with their number', () => {
  const { groups, nodes, edges } = foldGroups(picture, (group) => group === 'p', 'mixed');
  expect(groups.map((group) => group.id)).toEqual(['q']);
  expect(nodes.map((one) => [one.id, one.detail, one.look])).toEqual([['p', '1 added, 2 unchanged', 'mixed'], ['d', 'removed', 'fate-removed']]);
  expect(edges.map((edge) => [edge.source, edge.target, edge.label, edge.look])).toEqual([['p', 'd', '×2', 'mixed']]);
});

it('where nothing is folded everything is drawn', () => {
  const { nodes, edges } = foldGroups(picture, () => false, 'mixed');
  expect(nodes).toEqual(picture.nodes);
  expect(edges.map((edge) => edge.label)).toEqual([undefined, undefined, undefined]);
});
