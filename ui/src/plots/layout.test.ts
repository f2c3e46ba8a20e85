// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { layoutText, LayoutError, mostPanels, parseLayout, sourceText, type Panel } from './layout';

const panel: Panel = {
  id: 0, kind: 'time', title: '<b>speed</b>', columns: 2, rows: 1, seconds: 30,
  sources: [{ task: 'drive', port: 'velocity', path: ['forward'] }],
};
const shown = (change: object) => JSON.stringify({ segue_layout: 1, panels: [{ ...JSON.parse(layoutText([panel])).panels[0], ...change }] });

describe('layouts', () => {
  it('are the same after saving and loading', () => {
    const [read] = parseLayout(layoutText([panel]));
    expect({ ...read, id: 0 }).toEqual(panel);
    expect(layoutText([panel])).not.toContain('"id"');
    expect(parseLayout('{"segue_layout": 1, "panels": []}')).toEqual([]);
    expect(sourceText(panel.sources[0]!)).toBe('drive.velocity forward');
  });
  it.each([
    ['', 'not JSON'],
    ['[]', 'not a layout'],
    ['null', 'not a layout'],
    ['{"panels": []}', 'not a layout'],
    ['{"segue_layout": 2, "panels": []}', 'version 2'],
    ['{"segue_layout": "1", "panels": []}', 'version "1"'],
    ['{"segue_layout": 1, "panels": {}}', 'panels is not a list'],
    ['{"segue_layout": 1, "panels": [7]}', 'panels[0] is not a map'],
    ['{"segue_layout": 1, "panels": [], "script": "x"}', 'unknown key "script"'],
    ['{"segue_layout": 1, "panels": [], "__proto__": {}}', 'unknown key "__proto__"'],
    [JSON.stringify({ segue_layout: 1, panels: new Array(mostPanels + 1).fill({}) }), '24 are the most'],
    [shown({ kind: 'constructor' }), 'panels[0].kind is none of'],
    [shown({ columns: 1e9 }), 'panels[0].columns is not an integer from 1 to 3'],
    [shown({ seconds: '30' }), 'panels[0].seconds'],
    [shown({ sources: [] }), 'panels[0].sources is empty'],
    [shown({ sources: [{ task: '../etc', port: 'p', path: [] }] }), 'panels[0].sources[0].task is not the name'],
    [shown({ sources: [{ task: 't', port: 'p/q', path: [] }] }), 'panels[0].sources[0].port is not the name'],
    [shown({ sources: [{ task: 't', port: 'p', path: [1] }] }), 'path[0] is not text'],
    [shown({ title: 'x'.repeat(300) }), 'longer than 255'],
    [' '.repeat(1 << 19), 'longer than 256 KiB'],
  ])('refuses %.60s', (text, why) => {
    expect(() => parseLayout(text)).toThrow(LayoutError);
    expect(() => parseLayout(text)).toThrow(why);
  });
  it('refuses more ports than a browser may look at', () => {
    const sources = (from: number) => Array.from({ length: 16 }, (_, index) => ({ task: 't' + (from + index), port: 'p', path: [] }));
    const panels = [0, 16, 32, 48].map((from) => ({ ...panel, sources: sources(from) }));
    expect(() => parseLayout(layoutText(panels))).toThrow('64 ports; 48 are the most');
    expect(parseLayout(layoutText(panels.slice(0, 3)))).toHaveLength(3);
  });
});
