// SPDX-License-Identifier: Apache-2.0
import { axisHeight, moved, readableRow, rowAt, timeAt, wholeOf, xOf, yOf, zoomed, type Size, type Window } from '../../../segue/draw/gantt_chart.js';
import { drawChart, paletteOf, thinRow, type Bars, type Marks, type Palette } from './gantt';
import type { Run } from './run';

/** A run that has just begun is drawn as if it had lasted so long, in seconds. */
const shortestRun = 1e-3;

/** The run that is drawn, and the marks on it. */
export interface Drawn {
  run: Run;
  bars: Bars;
  marks: Marks;
}

function nowOf(run: Run): number {
  return run.ended || run.began === null ? run.until : Math.max(run.until, Date.now() / 1000 - run.began);
}

/** The visible part of a run on a canvas: it follows a run that goes on, until somebody zooms or moves it. */
export class ChartView {
  private held: Window | null = null;
  private palette: Palette | null = null;
  private pending = false;
  private place: HTMLElement | null = null;
  private canvas: HTMLCanvasElement | null = null;
  private size: Size = { width: 600, height: 300, gutter: 150 };

  /** `drawn` may be replaced at any time; draw() shows it. */
  constructor(public drawn: Drawn) {}

  get window(): Window {
    const window = this.held ?? wholeOf(Math.max(this.end, shortestRun));
    const most = Math.max(0, this.drawn.run.rows.length - this.roomForRows / window.rowHeight);
    return { ...window, top: Math.min(Math.max(0, window.top), most) };
  }

  /** null: the whole run. */
  show(window: Window | null): void {
    this.held = window;
    this.draw();
  }

  /** In time, by a factor, with the time at `x` where it is; without `x` that in the middle. */
  zoom(factor: number, x?: number): void {
    const window = this.window;
    const around = x === undefined ? (window.from + window.until) / 2 : timeAt(window, this.size, Math.max(x, this.size.gutter));
    this.show(zoomed(window, factor, around, this.end));
  }

  /** In time, by a share of what is seen. */
  move(share: number): void {
    const window = this.window;
    this.show(moved(window, share * (window.until - window.from), this.end));
  }

  scroll(pixels: number): void {
    const window = this.window;
    this.show({ ...window, top: window.top + pixels / window.rowHeight });
  }
  scrollPages(pages: number): void {
    this.scroll(pages * this.roomForRows);
  }

  /** As far as the pointer was dragged since `begun` was the window. */
  drag(begun: Window, x: number, y: number): void {
    const span = begun.until - begun.from;
    const window = moved(begun, (-x / (this.size.width - this.size.gutter)) * span, this.end);
    this.show({ ...window, top: begun.top - y / window.rowHeight });
  }

  /** Moves a row into view that is not. */
  reveal(row: number): void {
    const window = this.window;
    const y = yOf(window, row);
    if (row >= 0 && (y < axisHeight || y + window.rowHeight > this.size.height)) this.show({ ...window, top: row - this.roomForRows / window.rowHeight / 2 });
  }

  /** All rows, however thin, or again rows that can be read. */
  fitRows(): void {
    const window = this.window;
    const all = this.roomForRows / Math.max(1, this.drawn.run.rows.length);
    this.show({ ...window, top: 0, rowHeight: window.rowHeight >= thinRow && all < readableRow ? all : readableRow });
  }

  /** The row at a place of the page, or, where a wait of the selected row is there, the one that is waited for; -1: none. */
  rowAt(clientX: number, clientY: number): number {
    const box = this.canvas?.getBoundingClientRect();
    if (!box) return -1;
    const window = this.window;
    const { run, marks } = this.drawn;
    const row = rowAt(window, run.rows.length, clientY - box.top);
    const own = row >= 0 && row === marks.selected ? run.rows[row] : undefined;
    const start = own?.bars[0] ? xOf(window, this.size, own.bars[0].from) : Infinity;
    const x = clientX - box.left;
    const wait = x > this.size.gutter && x < start ? own?.waits[0] : undefined;
    return wait && wait.row >= 0 ? wait.row : row;
  }

  /** Draws before the next frame of the screen, once for all requests until then. */
  draw(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      const context = this.canvas?.getContext('2d');
      if (!context || !this.place) return;
      this.palette ??= paletteOf(this.place);
      const { bars, marks } = this.drawn;
      const chart = { context, window: this.window, size: this.size, palette: this.palette };
      drawChart(chart, bars, marks, this.end, globalThis.devicePixelRatio || 1);
    });
  }

  /** Draws on this canvas, as large as the place, until the function that it returns is called. */
  mount(place: HTMLElement, canvas: HTMLCanvasElement): () => void {
    [this.place, this.canvas] = [place, canvas];
    const watch = new ResizeObserver(() => this.measure(place, canvas));
    watch.observe(place);
    const dark = matchMedia('(prefers-color-scheme: dark)');
    const repaint = () => {
      this.palette = null;
      this.draw();
    };
    dark.addEventListener('change', repaint);
    // Not by React, whose listeners cannot keep the page from zooming.
    const turn = (event: WheelEvent) => this.turn(event, event.clientX - canvas.getBoundingClientRect().left);
    canvas.addEventListener('wheel', turn, { passive: false });
    return () => {
      watch.disconnect();
      dark.removeEventListener('change', repaint);
      canvas.removeEventListener('wheel', turn);
      this.place = this.canvas = null;
    };
  }

  /** Until when the run is drawn. */
  private get end(): number {
    return nowOf(this.drawn.run);
  }
  private get roomForRows(): number {
    return this.size.height - axisHeight;
  }

  private measure(place: HTMLElement, canvas: HTMLCanvasElement): void {
    const ratio = globalThis.devicePixelRatio || 1;
    const width = place.clientWidth;
    const height = place.clientHeight;
    this.size = { width, height, gutter: Math.min(210, width * 0.3) };
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    this.draw();
  }

  private turn(event: WheelEvent, x: number): void {
    event.preventDefault();
    if (event.ctrlKey || event.metaKey) this.zoom(Math.exp(event.deltaY * 0.002), x);
    else if (event.shiftKey || event.deltaX !== 0) this.move((event.deltaX || event.deltaY) / this.size.width);
    else this.scroll(event.deltaY);
  }
}
