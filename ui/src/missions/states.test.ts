// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Plan } from './mission';
import { openAtFirst, stateGraphOf } from './states';

const plan: Plan = {
  mission: 'fetch', complete: true, nodes: null,
  states: [
    { path: '', title: 'fetch', kind: 'hierarchy', start: 'get', next: [], flows: [{ from: 'get', to: 'put', what: 'pose -> pose' }] },
    { path: 'get', in: '', title: 'Get it', kind: 'barrier', next: [{ outcome: 'success', to: 'put' }, { outcome: 'empty', to: 'put' }], flows: [] },
    { path: 'put', in: '', title: 'put', kind: 'execution', action: 'put', next: [{ outcome: 'success', returns: 'done' }] },
    { path: 'get/look', in: 'get', title: 'look', kind: 'execution', action: 'look', next: [] },
  ],
};

describe('the graph of states', () => {
  it('is nested where containers are open', () => {
    const graph = stateGraphOf(plan, new Map([['get', 'running'], ['get/look', 'running']]), openAtFirst(plan), true);
    expect(graph.groups).toEqual([{ id: 'state:get', group: undefined, title: '▾ ▶ Get it (barrier, running)', look: 'life-running' }]);
    expect(graph.nodes.map((node) => [node.id, node.group, node.detail])).toEqual([['state:put', undefined, '↩ done'.replace('↩', 'success ↩')], ['state:get/look', 'state:get', 'running']]);
    expect(graph.edges.map((edge) => [edge.source, edge.target, edge.label, edge.look])).toEqual([
      ['state:get', 'state:put', 'success, empty', 'transition'], ['state:get', 'state:put', 'pose -> pose', 'flow'],
    ]);
  });
  it('hides what is in closed containers', () => {
    const graph = stateGraphOf(plan, new Map(), new Set(), false);
    expect(graph.nodes.map((node) => node.title)).toEqual(['▸ ▶ Get it', 'put']);
    expect(graph.edges).toHaveLength(1);
  });
  it('is a single state where the mission is one', () => {
    const one: Plan = { mission: 'drive', complete: true, nodes: null, states: [{ path: '', title: '', kind: 'execution', action: 'drive_to', next: [] }] };
    expect(stateGraphOf(one, new Map(), new Set(), false).nodes).toEqual([{ id: 'state:', group: undefined, title: 'drive', detail: 'drive_to', look: 'life-idle' }]);
  });
  it('opens what can be seen at first', () => {
    const many: Plan = { ...plan, states: Array.from({ length: 100 }, (_, i) => ({ path: 's' + i, in: '', title: '', kind: 'hierarchy', next: [] })) };
    expect(openAtFirst(many).size).toBe(40);
  });
});
