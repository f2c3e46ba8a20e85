// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { noLayout, type Layout, type LayoutInput } from './boxes';
import { liftedEdges } from './elk_graph';
import { Layouter } from './layout';

it('what became old while it waited is not laid out', async () => {
  const begun: string[] = [];
  const taken: string[] = [];
  const ends: (() => void)[] = [];
  const layouter = new Layouter((input: LayoutInput) => {
    begun.push(input.roots[0]?.id ?? '');
    return new Promise<Layout>((resolve) => ends.push(() => resolve(noLayout)));
  });
  for (const id of ['a', 'b', 'c']) layouter.ask({ roots: [{ id }], edges: [] }, () => taken.push(id));
  expect(begun).toEqual(['a']);
  ends[0]?.();
  await Promise.resolve();
  await Promise.resolve();
  expect(begun).toEqual(['a', 'c']);
  ends[1]?.();
  await Promise.resolve();
  await Promise.resolve();
  expect(taken).toEqual(['c']);
});

it('edges between boxes are lifted to where both ends are', () => {
  const roots = [{ id: 'host', children: [{ id: 'p', children: [{ id: 'a' }, { id: 'b' }] }, { id: 'q', children: [{ id: 'c' }] }] }, { id: 'd' }];
  const edge = (source: string, target: string) => ({ id: source + target, source, target });
  const lifted = liftedEdges({ roots, edges: [edge('a', 'b'), edge('a', 'c'), edge('b', 'c'), edge('c', 'd'), edge('a', 'a'), edge('a', 'gone')] });
  expect([...lifted].map(([around, edges]) => [around, edges.map((one) => [one.source, one.target])])).toEqual([
    ['p', [['a', 'b'], ['a', 'a']]],
    ['host', [['p', 'q']]],
    ['', [['host', 'd']]],
  ]);
});
