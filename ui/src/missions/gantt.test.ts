// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { axisHeight, moved, rowAt, ticksOf, timeAt, xOf, zoomed } from '../../../segue/draw/gantt_chart.js';
import { Bars, paint, pixelOf, type Palette } from './gantt';
import type { Row } from './run';

function row(from: number, until: number): Row {
  return { label: '', status: 'done', outcome: '', error: '', critical: false, ahead: false, bars: [{ from, until, discarded: false }], waits: [] };
}

describe('the window of a chart', () => {
  const window = { from: 10, until: 20, top: 100, rowHeight: 20 };
  const size = { width: 600, height: 400, gutter: 100 };
  it('goes from times to places and back', () => {
    expect(xOf(window, size, 15)).toBe(350);
    expect(timeAt(window, size, 350)).toBe(15);
    expect(rowAt(window, 1000, axisHeight + 45)).toBe(102);
    expect(rowAt(window, 101, axisHeight + 45)).toBe(-1);
    expect(rowAt(window, 1000, 3)).toBe(-1);
  });
  it('stays at the run', () => {
    expect(zoomed(window, 0.5, 15, 100)).toMatchObject({ from: 12.5, until: 17.5 });
    const all = zoomed(window, 1000, 15, 100);
    expect(all.until - all.from).toBeCloseTo(105);
    expect(moved(window, -50, 100).from).toBeCloseTo(-0.2);
    expect(moved(window, 500, 100).until).toBeCloseTo(103);
  });
  it('has round times', () => {
    expect(ticksOf(0, 10, 5)).toEqual({ times: [0, 2, 4, 6, 8, 10], digits: 0 });
    expect(ticksOf(0.1, 0.3, 2).times).toHaveLength(3);
    expect(ticksOf(7.1, 7.9, 1)).toEqual({ times: [], digits: 0 });
    expect(ticksOf(0, 1e-6, 5).digits).toBe(7);
  });
});

describe('many bars', () => {
  it('are a pixel at the least, wherever they are', () => {
    const bars = new Bars([row(0, 1), row(1, Infinity), row(5, 5.0001)]);
    const picture = new Uint32Array(10 * 3);
    const palette = { pixels: Uint32Array.from([1, 2, 3, 4, 5, 6, 7, 8]) } as unknown as Palette;
    paint(picture, 10, 3, bars, { from: 0, until: 10, top: 0, rowHeight: 1 }, palette, 4);
    expect([...picture]).toEqual([3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 3, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0]);
  });
  it('are drawn over each other where rows are thinner than pixels', () => {
    const bars = new Bars(Array.from({ length: 1000 }, (_, i) => row(i, i + 1)));
    const picture = new Uint32Array(100 * 10);
    const palette = { pixels: new Uint32Array(8).fill(7) } as unknown as Palette;
    paint(picture, 100, 10, bars, { from: 0, until: 1000, top: 0, rowHeight: 0.01 }, palette, 1000);
    expect(picture.filter((pixel) => pixel === 7)).toHaveLength(100);
  });
  it('show trouble over what is drawn at the same place', () => {
    const bars = new Bars([{ ...row(0, 10), status: 'failed' }, row(0, 10)]);
    const picture = new Uint32Array(10);
    const palette = { pixels: Uint32Array.from([1, 2, 3, 4, 5, 6, 7, 8]) } as unknown as Palette;
    paint(picture, 10, 1, bars, { from: 0, until: 10, top: 0, rowHeight: 0.1 }, palette, 10);
    expect([...picture]).toEqual(new Array(10).fill(4));
  });
  it('have the colours of the page', () => {
    expect(pixelOf('#102030').toString(16)).toBe('ff302010');
    expect(pixelOf('#abc')).toBe(pixelOf('#aabbcc'));
  });
});
