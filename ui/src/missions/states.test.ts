// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { livesOf, type Life, type Plan } from './mission';
import { followedOf, openFor, openLevels, stateGraphOf } from './states';
import { mission } from './testing';

const plan: Plan = {
  mission: 'fetch', complete: true, nodes: null,
  states: [
    { path: '', title: 'fetch', kind: 'hierarchy', start: 'get', next: [], flows: [{ from: 'get', to: 'put', what: 'pose -> pose' }] },
    { path: 'get', in: '', title: 'Get it', kind: 'barrier', next: [{ outcome: 'success', to: 'put' }, { outcome: 'empty', to: 'put' }], flows: [] },
    { path: 'put', in: '', title: 'put', kind: 'execution', action: 'put', next: [{ outcome: 'success', returns: 'done' }] },
    { path: 'get/look', in: 'get', title: 'look', kind: 'execution', action: 'look', next: [] },
  ],
};

const progress = (lives = new Map<string, Life>(), waits = new Map<string, string[]>()) => ({ lives, waits });

describe('the graph of states', () => {
  it('says for what a state waits', () => {
    const graph = stateGraphOf(plan, progress(new Map([['put', 'waiting'], ['get', 'running']]), new Map([['put', ['look (data pose)', 'arm (fact free())']], ['get', ['nothing']]])), new Set(), false);
    expect(graph.nodes.map((node) => [node.look, node.detail])).toEqual([
      ['life-running', 'running · barrier, 1 state'], ['life-waiting', 'waits for look (data pose); arm (fact free())'],
    ]);
  });
  it('is nested where containers are open', () => {
    const graph = stateGraphOf(plan, progress(new Map([['get', 'running'], ['get/look', 'running']])), openLevels(plan)[0] ?? new Set(), true);
    expect(graph.groups).toEqual([{ id: 'state:get', group: undefined, title: '▶ Get it (barrier, running)', look: 'life-running', first: true, expanded: true }]);
    expect(graph.nodes.map((node) => [node.id, node.group, node.detail])).toEqual([['state:put', undefined, '↩ done'.replace('↩', 'success ↩')], ['state:get/look', 'state:get', 'running']]);
    expect(graph.edges.map((edge) => [edge.source, edge.target, edge.label, edge.look])).toEqual([
      ['state:get', 'state:put', 'success, empty', 'transition'], ['state:get', 'state:put', 'pose -> pose', 'flow'],
    ]);
  });
  it('hides what is in closed containers', () => {
    const graph = stateGraphOf(plan, progress(), new Set(), false);
    expect(graph.nodes.map((node) => [node.title, node.expanded])).toEqual([['▶ Get it', false], ['put', undefined]]);
    expect(graph.edges).toHaveLength(1);
  });
  it('marks breakpoints, also those in closed containers, and what is next', () => {
    const lives = livesOf(mission(null, { entries: {} }), ['put']);
    const graph = stateGraphOf(plan, progress(lives), new Set(), false, { at: ['get/look', 'put'], fixed: false });
    expect(graph.nodes.map((node) => [node.detail, node.look, node.mark])).toEqual([
      ['barrier, 1 state · ● inside', 'life-idle', { on: false, label: 'Breakpoint at get', fixed: false }],
      ['next · success ↩ done', 'life-next', { on: true, label: 'Breakpoint at put', fixed: false }],
    ]);
    expect(stateGraphOf(plan, progress(lives), new Set(['get']), false, { at: [], fixed: true }).groups[0]?.mark).toEqual({ on: false, label: 'Breakpoint at get', fixed: true });
  });
  it('opens what is around the states before which the mission is held', () => {
    expect(openFor(['put', 'get/look', 'a/b/c'])).toEqual(['get', 'a', 'a/b']);
  });
  it('is a single state where the mission is one', () => {
    const one: Plan = { mission: 'drive', complete: true, nodes: null, states: [{ path: '', title: '', kind: 'execution', action: 'drive_to', next: [] }] };
    expect(stateGraphOf(one, progress(), new Set(), false).nodes).toEqual([{ id: 'state:', group: undefined, title: 'drive', detail: 'drive_to', look: 'life-idle', first: false, isWide: true }]);
  });
  it('opens what can be seen at first', () => {
    const many: Plan = { ...plan, states: Array.from({ length: 100 }, (_, i) => ({ path: 's' + i, in: '', title: '', kind: 'hierarchy', next: [] })) };
    expect(openLevels(many).map((level) => level.size)).toEqual([40, 0]);
  });
  it('opens the outermost containers where not all can be read, then none', () => {
    const inner: Plan = { ...plan, states: ['', 'a', 'a/b', 'a/b/c', 'd', 'e', 'f', 'g'].map((path) => ({ path, in: '', title: '', kind: path.length < 4 && path < 'b' ? 'hierarchy' : 'execution', next: [] })) };
    expect(openLevels(inner).map((level) => [...level])).toEqual([['a', 'a/b'], ['a'], []]);
    expect(openLevels(plan)).toHaveLength(1); // two boxes would tell too little
  });
  it('follows where the mission is held, or else what runs', () => {
    const lives = new Map<string, Life>([['get', 'running'], ['get/look', 'running']]);
    expect(followedOf(plan, [], lives)).toEqual(['get/look']);
    expect(followedOf(plan, ['put'], lives)).toEqual(['put']);
  });
});
