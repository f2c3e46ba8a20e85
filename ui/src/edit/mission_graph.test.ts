// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { flowPartners, meaningOf, missionGraph, openAtFirst, stateNode } from './mission_graph';
import { missionIn } from './mission_text';

const mission = missionIn(`mission: m
actions: {look: {outputs: {pose: map, n: int}, outcomes: [found]}, grasp: {inputs: {pose: map, x: float}}}
inputs: {box: text}
outcomes: [done]
start: look
flows: [look.pose -> grasp.pose]
states:
  look: {on: {found: inner, aborted: return done}}
  grasp: {on: {success: return done}}
  inner: {start: look, states: {look: {on: {found: return success}}}, on: {success: grasp}}
`)!;
const root = mission.machines[0]!.root;
const from = (node: string, port: string) => ({ node, port });
const into = (node: string) => ({ node, port: 'in' });

it('transitions lead to siblings and to ends of their container', () => {
  const graph = missionGraph(mission, [], root, openAtFirst(root), 'transitions');
  expect(graph.groups.map((group) => group.id)).toEqual(['state:inner']);
  expect(graph.nodes.map((node) => node.id)).toEqual(['start:', 'end::done', 'state:look', 'state:grasp', 'start:inner', 'end:inner:success', 'state:inner/look']);
  expect(graph.edges.map((edge) => edge.source + ' ' + edge.sourcePort + ' ' + edge.target)).toEqual([
    'state:look found state:inner', 'state:look aborted end::done', 'state:grasp success end::done', 'state:inner success state:grasp', 'start: start state:look',
    'state:inner/look found end:inner:success', 'start:inner start state:inner/look',
  ]);
  const closed = missionGraph(mission, [], root, new Set(), 'transitions');
  expect(closed.nodes.find((node) => node.id === stateNode('inner'))?.detail).toBe('hierarchy, closed');
});
it('only what exists is connected', () => {
  const meaning = (a: { node: string; port: string }, b: { node: string; port: string }) => meaningOf(mission, [], root, 'transitions', a, b);
  expect(meaning(from('state:grasp', 'success'), into('state:look'))).toMatchObject({ outcome: 'success', target: 'look' });
  expect(meaning(from('state:grasp', 'success'), into('end::done'))).toMatchObject({ target: 'return done' });
  expect(meaning(from('start:', 'start'), into('state:grasp'))).toMatchObject({ start: 'grasp' });
  expect(meaning(from('state:grasp', 'success'), into('state:inner/look'))).toBeNull();
  expect(meaning(from('state:grasp', 'success'), into('end:inner:success'))).toBeNull();
  expect(meaningOf(mission, [], root, 'flows', from('state:look', 'n'), from('state:grasp', 'x'))).toMatchObject({ from: 'look.n', to: 'grasp.x' });
  expect(meaningOf(mission, [], root, 'flows', from('state:look', 'pose'), from('state:grasp', 'x'))).toBeNull();
  expect(flowPartners(mission, [], root, 'grasp.x', 'to')).toEqual(['look.n']);
});
