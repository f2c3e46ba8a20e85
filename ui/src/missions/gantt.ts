// SPDX-License-Identifier: Apache-2.0
import { axisHeight, drawAxis, drawReasons, drawRows, fit, setUp, yOf, type BarLook, type Chart, type Palette as Colours, type RowLook, type Window } from '../../../segue/draw/gantt_chart.js';
import type { Bar, Row, RowStatus } from './run';

/** Thinner rows have no labels and are drawn as pixels, however many there are. */
export const thinRow = 6;

export const statusColours: Record<RowStatus, string> = {
  waiting: '--quiet', running: '--come', done: '--good', failed: '--bad', preempted: '--warn', skipped: '--line', discarded: '--quiet', lost: '--bad',
};
const statusNames = Object.keys(statusColours) as RowStatus[];
const discardedColour = statusNames.indexOf('discarded');
const troubleColours = new Set([statusNames.indexOf('failed'), statusNames.indexOf('lost')]);

/** Bars of all rows as columns, in the order of rows; so that a hundred thousand of them are drawn in a few milliseconds. */
export class Bars {
  readonly first: Uint32Array;
  readonly from: Float64Array;
  readonly until: Float64Array;
  readonly colour: Uint8Array;

  constructor(readonly rows: Row[]) {
    const count = rows.reduce((sum, row) => sum + row.bars.length, 0);
    this.first = new Uint32Array(rows.length + 1);
    this.from = new Float64Array(count);
    this.until = new Float64Array(count);
    this.colour = new Uint8Array(count);
    let at = 0;
    rows.forEach((row, index) => {
      this.first[index] = at;
      const own = statusNames.indexOf(row.status);
      for (const bar of row.bars) {
        this.from[at] = bar.from;
        this.until[at] = bar.until;
        this.colour[at] = bar.discarded ? discardedColour : own;
        ++at;
      }
    });
    this.first[rows.length] = at;
  }
}

export interface Palette extends Colours {
  accent: string;
  byStatus: string[];
  /** The colours `byStatus` as pixels. */
  pixels: Uint32Array;
}

/** The colours of the page as it is now: light or dark. */
export function paletteOf(element: Element): Palette {
  const style = getComputedStyle(element);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  const byStatus = statusNames.map((status) => colour(statusColours[status]));
  return {
    text: colour('--text'), quiet: colour('--quiet'), line: colour('--line'), grid: colour('--line'), back: colour('--back'), front: colour('--front'), onBar: colour('--front'),
    critical: colour('--text'), ahead: colour('--accent'), discarded: colour('--quiet'), accent: colour('--accent'), byStatus, pixels: Uint32Array.from(byStatus.map(pixelOf)),
  };
}

/** "#rrggbb" or "#rgb" as a little-endian pixel without transparency. */
export function pixelOf(colour: string): number {
  const digits = colour.slice(1);
  const rgb = Number.parseInt(digits.length === 3 ? digits.replace(/./g, '$&$&') : digits, 16);
  return ((0xff << 24) | ((rgb & 0xff) << 16) | (rgb & 0xff00) | (rgb >> 16)) >>> 0;
}

export interface Marks {
  selected: number;
  /** Rows that a search has found; null: there is none. */
  found: Set<number> | null;
  onlyCritical: boolean;
}

interface StatusChart extends Chart {
  palette: Palette;
}

const colourOf = (palette: Palette, status: RowStatus): string => palette.byStatus[statusNames.indexOf(status)] ?? palette.text;

function isFaint(row: Row, index: number, { found, onlyCritical }: Marks): boolean {
  return (found !== null && !found.has(index)) || (onlyCritical && !row.critical);
}

/** The waits of a row until it began; why it waits last is written on it. */
function waitsOf(row: Row, palette: Palette, now: number) {
  const start = row.bars[0]?.from ?? now;
  return row.waits.map((wait, at) => ({
    from: wait.from, until: Math.min(wait.until, start), colour: palette.quiet, because: at === row.waits.length - 1 ? wait.because : '',
  }));
}

function rowLook(row: Row, faint: boolean, palette: Palette, now: number): RowLook<Bar> {
  const isTrouble = row.status === 'failed' || row.status === 'lost';
  const lookOf = (bar: Bar): BarLook => ({
    colour: colourOf(palette, row.status), discarded: bar.discarded || row.status === 'discarded', ahead: row.ahead, critical: row.critical, faint, text: '', outline: 0,
  });
  return {
    label: { text: row.label, critical: row.critical, colour: isTrouble ? colourOf(palette, 'failed') : row.bars.length > 0 ? palette.text : palette.quiet },
    faint, waits: waitsOf(row, palette, now), bars: row.bars.map((bar) => ({ ...bar, until: Math.min(bar.until, now) })), inOrder: false, lookOf,
  };
}

/** From the ends of what the selected row waited for, or waits for. */
function drawSelected(chart: StatusChart, rows: Row[], selected: number, now: number): void {
  const waits = rows[selected]?.waits.filter((wait) => wait.row >= 0) ?? [];
  drawReasons(chart, waits.map((wait) => ({ time: Math.min(wait.until, now), from: wait.row, to: selected, colour: chart.palette.accent })));
}

/** Every bar, a pixel at the least, into a picture of the whole area; trouble over all others. */
export function paint(picture: Uint32Array, width: number, height: number, bars: Bars, window: Window, palette: Palette, now: number): void {
  const scale = width / (window.until - window.from);
  const thickness = Math.max(1, Math.floor(window.rowHeight));
  const first = Math.max(0, Math.floor(window.top));
  const last = Math.min(bars.rows.length, Math.ceil(window.top + height / window.rowHeight) + 1);
  const paintRow = (row: number, onlyTrouble: boolean) => {
    const top = Math.max(0, Math.floor((row - window.top) * window.rowHeight));
    const bottom = Math.min(height, top + thickness);
    const lastBar = bars.first[row + 1] as number;
    for (let bar = bars.first[row] as number; bar < lastBar; ++bar) {
      const colour = bars.colour[bar] as number;
      if (onlyTrouble && !troubleColours.has(colour)) continue;
      const from = ((bars.from[bar] as number) - window.from) * scale;
      const until = (Math.min(bars.until[bar] as number, now) - window.from) * scale;
      if (until < 0 || from >= width) continue;
      const left = from > 0 ? Math.floor(from) : 0;
      const right = until < width ? Math.max(left + 1, Math.ceil(until)) : width;
      const pixel = palette.pixels[colour] as number;
      for (let y = top; y < bottom; ++y) {
        const end = y * width + right;
        for (let at = y * width + left; at < end; ++at) picture[at] = pixel;
      }
    }
  };
  for (const onlyTrouble of [false, true]) for (let row = first; row < last; ++row) paintRow(row, onlyTrouble);
}

function drawThin({ context, window, size, palette }: StatusChart, bars: Bars, marks: Marks, now: number, ratio: number): void {
  const width = Math.floor((size.width - size.gutter) * ratio);
  const height = Math.floor((size.height - axisHeight) * ratio);
  if (width <= 0 || height <= 0) return;
  const image = context.createImageData(width, height);
  const scaled = { ...window, rowHeight: window.rowHeight * ratio };
  const picture = new Uint32Array(image.data.buffer).fill(pixelOf(palette.front));
  paint(picture, width, height, bars, scaled, palette, now);
  context.putImageData(image, Math.floor(size.gutter * ratio), Math.floor(axisHeight * ratio));
  context.textAlign = 'left';
  context.fillStyle = palette.quiet;
  const shown = Math.min(bars.rows.length, Math.ceil((size.height - axisHeight) / window.rowHeight));
  context.fillText(fit(context, shown + ' rows', size.gutter - 16), 9, axisHeight + 12);
  for (const row of marks.found ?? []) {
    const y = yOf(window, row);
    if (y < axisHeight || y > size.height) continue;
    context.fillStyle = palette.accent;
    context.fillRect(size.gutter - 6, y, 6, Math.max(1, window.rowHeight));
  }
}

/** The chart as it is seen through the window; `now`: until when bars that run are drawn. */
export function drawChart(chart: StatusChart, bars: Bars, marks: Marks, now: number, ratio: number): void {
  const { context, window, size, palette } = chart;
  setUp(context, ratio);
  context.fillStyle = palette.front;
  context.fillRect(0, 0, size.width, size.height);
  const readable = window.rowHeight >= thinRow;
  if (!readable) drawThin(chart, bars, marks, now, ratio);
  if (marks.selected >= 0) {
    context.fillStyle = palette.accent;
    context.globalAlpha = 0.18;
    context.fillRect(0, yOf(window, marks.selected), size.width, Math.max(2, window.rowHeight));
    context.globalAlpha = 1;
  }
  drawAxis(chart);
  const lookOf = (index: number) => rowLook(bars.rows[index] as Row, isFaint(bars.rows[index] as Row, index, marks), palette, now);
  if (readable) drawRows(chart, bars.rows.length, lookOf);
  drawSelected(chart, bars.rows, marks.selected, now);
}
