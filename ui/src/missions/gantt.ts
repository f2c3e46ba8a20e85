// SPDX-License-Identifier: Apache-2.0
import type { Row, RowStatus, Run } from './run';

/** The measures of a chart, in pixels. */
export const axisHeight = 24;
export const readableRow = 20;
/** Thinner rows have no labels and are drawn as pixels, however many there are. */
export const thinRow = 6;

/** The part of the run that is seen. */
export interface Window {
  from: number;
  until: number;
  /** The number of the first row that is seen; it may have a fraction. */
  top: number;
  rowHeight: number;
}

export interface Size {
  width: number;
  height: number;
  gutter: number;
}

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

export interface Palette {
  text: string;
  quiet: string;
  line: string;
  back: string;
  front: string;
  accent: string;
  critical: string;
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
    text: colour('--text'), quiet: colour('--quiet'), line: colour('--line'), back: colour('--back'), front: colour('--front'),
    accent: colour('--accent'), critical: colour('--warn'), byStatus, pixels: Uint32Array.from(byStatus.map(pixelOf)),
  };
}

/** "#rrggbb" or "#rgb" as a little-endian pixel without transparency. */
export function pixelOf(colour: string): number {
  const digits = colour.slice(1);
  const rgb = Number.parseInt(digits.length === 3 ? digits.replace(/./g, '$&$&') : digits, 16);
  return ((0xff << 24) | ((rgb & 0xff) << 16) | (rgb & 0xff00) | (rgb >> 16)) >>> 0;
}

export function xOf(window: Window, size: Size, time: number): number {
  return size.gutter + ((time - window.from) / (window.until - window.from)) * (size.width - size.gutter);
}

export function timeAt(window: Window, size: Size, x: number): number {
  return window.from + ((x - size.gutter) / (size.width - size.gutter)) * (window.until - window.from);
}

/** -1: none. */
export function rowAt(window: Window, rows: number, y: number): number {
  const row = Math.floor(window.top + (y - axisHeight) / window.rowHeight);
  return y >= axisHeight && row >= 0 && row < rows ? row : -1;
}

export function yOf(window: Window, row: number): number {
  return axisHeight + (row - window.top) * window.rowHeight;
}

/** Zoomed in time by a factor, with the time at `around` where it is; within a little more than the run. */
export function zoomed(window: Window, factor: number, around: number, end: number): Window {
  const span = Math.min(Math.max((window.until - window.from) * factor, 1e-6), Math.max(end, 1e-6) * 1.05);
  const share = (around - window.from) / (window.until - window.from);
  return moved({ ...window, from: around - share * span, until: around + (1 - share) * span }, 0, end);
}

export function moved(window: Window, by: number, end: number): Window {
  const span = window.until - window.from;
  const from = Math.min(Math.max(window.from + by, -0.02 * span), Math.max(end * 1.03 - span, -0.02 * span));
  return { ...window, from, until: from + span };
}

/** Round times for the axis. */
export function ticksOf(from: number, until: number, most: number): number[] {
  const rough = (until - from) / Math.max(1, most);
  const unit = 10 ** Math.floor(Math.log10(rough));
  const step = unit * ([1, 2, 5, 10].find((factor) => factor * unit >= rough) ?? 10);
  const ticks: number[] = [];
  for (let i = Math.ceil(from / step - 1e-9) + 0; i * step <= until + step * 1e-9; ++i) ticks.push(i * step);
  return ticks;
}

function digitsOf(ticks: number[]): number {
  const step = (ticks[1] ?? 1) - (ticks[0] ?? 0);
  return Math.max(0, Math.min(6, -Math.floor(Math.log10(step) + 1e-9)));
}

function drawAxis(context: CanvasRenderingContext2D, window: Window, size: Size, palette: Palette): void {
  const ticks = ticksOf(window.from, window.until, (size.width - size.gutter) / 90);
  const digits = digitsOf(ticks);
  context.fillStyle = palette.back;
  context.fillRect(0, 0, size.width, axisHeight);
  context.textAlign = 'center';
  for (const time of ticks) {
    const x = xOf(window, size, time);
    if (x < size.gutter || x > size.width - 20) continue;
    context.fillStyle = palette.quiet;
    context.fillText(time.toFixed(digits) + ' s', x, axisHeight / 2);
    context.fillStyle = palette.line;
    context.fillRect(Math.round(x), axisHeight, 1, size.height);
  }
  context.fillRect(0, axisHeight - 1, size.width, 1);
}

/** Shortened at its begin so that it fits: what a path ends with tells more. */
function fit(context: CanvasRenderingContext2D, text: string, room: number): string {
  if (context.measureText(text).width <= room) return text;
  let low = 0;
  let high = text.length;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (context.measureText('…' + text.slice(-middle)).width <= room) low = middle;
    else high = middle - 1;
  }
  return '…' + text.slice(text.length - low);
}

export interface Marks {
  selected: number;
  /** Rows that a search has found; null: there is none. */
  found: Set<number> | null;
  onlyCritical: boolean;
}

const readableReason = 70;

/** Writes the reason of a wait on its line, where there is room for it. */
function writeReason(context: CanvasRenderingContext2D, because: string, left: number, middle: number, room: number, palette: Palette): void {
  if (room < readableReason) return;
  let text = because;
  while (text.length > 1 && context.measureText(text + '…').width > room) text = text.slice(0, Math.floor(text.length * 0.85));
  if (text !== because) text += '…';
  context.textAlign = 'left';
  context.fillStyle = palette.front;
  context.fillRect(left - 3, middle - 7, context.measureText(text).width + 6, 14);
  context.fillStyle = palette.quiet;
  context.fillText(text, left, middle);
}

function drawRow(context: CanvasRenderingContext2D, bars: Bars, index: number, window: Window, size: Size, palette: Palette, marks: Marks, now: number): void {
  const row = bars.rows[index] as Row;
  const top = yOf(window, index);
  const height = window.rowHeight;
  const faint = (marks.found !== null && !marks.found.has(index)) || (marks.onlyCritical && !row.critical);
  context.globalAlpha = faint ? 0.25 : 1;
  for (const wait of row.waits) {
    const from = Math.max(size.gutter, xOf(window, size, wait.from));
    const start = row.bars[0]?.from ?? now;
    const until = Math.min(size.width, xOf(window, size, Math.min(wait.until, start)));
    if (until <= from) continue;
    context.fillStyle = palette.quiet;
    context.fillRect(from, top + height / 2 - 1, until - from, 2);
    if (wait === row.waits[row.waits.length - 1]) writeReason(context, wait.because, from + 14, top + height / 2, until - from - 28, palette);
  }
  for (let bar = bars.first[index] ?? 0; bar < (bars.first[index + 1] ?? 0); ++bar) {
    const left = Math.max(size.gutter, xOf(window, size, bars.from[bar] ?? 0));
    const right = Math.min(size.width, xOf(window, size, Math.min(bars.until[bar] ?? 0, now)));
    if (right < size.gutter || left > size.width) continue;
    const colour = bars.colour[bar] ?? 0;
    const width = Math.max(1.5, right - left);
    context.fillStyle = context.strokeStyle = palette.byStatus[colour] ?? palette.text;
    if (colour === discardedColour) {
      context.setLineDash([4, 3]);
      context.strokeRect(left + 0.5, top + 4.5, Math.max(1, width - 1), height - 9);
      context.setLineDash([]);
    } else {
      context.fillRect(left, top + 4, width, height - 8);
    }
    if (row.ahead) {
      context.fillStyle = palette.accent;
      context.fillRect(left, top + 1, width, 2);
    }
    if (row.critical) {
      context.fillStyle = palette.critical;
      context.fillRect(left, top + height - 3, width, 3);
    }
  }
  context.textAlign = 'left';
  context.fillStyle = row.status === 'failed' || row.status === 'lost' ? (palette.byStatus[statusNames.indexOf('failed')] ?? '') : row.bars.length > 0 ? palette.text : palette.quiet;
  context.fillText(fit(context, (row.critical ? '◆ ' : '') + row.label, size.gutter - 14), 7, top + height / 2);
  context.globalAlpha = 1;
}

/** Draws lines to the selected row from the end of each row that it waited for, or waits for. */
function drawReasons(context: CanvasRenderingContext2D, bars: Bars, window: Window, size: Size, palette: Palette, selected: number, now: number): void {
  const row = bars.rows[selected];
  if (!row) return;
  context.strokeStyle = palette.accent;
  context.lineWidth = 1.5;
  for (const wait of row.waits) {
    if (wait.row < 0) continue;
    const x = xOf(window, size, Math.min(wait.until, now));
    if (x < size.gutter || x > size.width) continue;
    context.beginPath();
    context.moveTo(x, yOf(window, wait.row) + window.rowHeight / 2);
    context.lineTo(x, yOf(window, selected) + window.rowHeight / 2);
    context.stroke();
  }
  context.lineWidth = 1;
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

function drawThin(context: CanvasRenderingContext2D, bars: Bars, window: Window, size: Size, palette: Palette, marks: Marks, now: number, ratio: number): void {
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
  context.fillText(fit(context, shown + ' rows', size.gutter - 14), 7, axisHeight + 12);
  for (const row of marks.found ?? []) {
    const y = yOf(window, row);
    if (y < axisHeight || y > size.height) continue;
    context.fillStyle = palette.accent;
    context.fillRect(size.gutter - 6, y, 6, Math.max(1, window.rowHeight));
  }
}

/** The chart as it is seen through the window; `now`: until when bars that run are drawn. */
export function drawChart(context: CanvasRenderingContext2D, bars: Bars, window: Window, size: Size, palette: Palette, marks: Marks, now: number, ratio: number): void {
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.font = '12px system-ui, "Segoe UI", "DejaVu Sans", sans-serif';
  context.textBaseline = 'middle';
  context.fillStyle = palette.front;
  context.fillRect(0, 0, size.width, size.height);
  const readable = window.rowHeight >= thinRow;
  if (!readable) drawThin(context, bars, window, size, palette, marks, now, ratio);
  if (marks.selected >= 0) {
    context.fillStyle = palette.accent;
    context.globalAlpha = 0.18;
    context.fillRect(0, yOf(window, marks.selected), size.width, Math.max(2, window.rowHeight));
    context.globalAlpha = 1;
  }
  if (readable) {
    drawAxis(context, window, size, palette);
    context.save();
    context.beginPath();
    context.rect(0, axisHeight, size.width, size.height - axisHeight);
    context.clip();
    const last = Math.min(bars.rows.length, Math.ceil(window.top + (size.height - axisHeight) / window.rowHeight));
    for (let row = Math.max(0, Math.floor(window.top)); row < last; ++row) drawRow(context, bars, row, window, size, palette, marks, now);
  } else {
    context.save();
  }
  if (marks.selected >= 0) drawReasons(context, bars, window, size, palette, marks.selected, now);
  context.restore();
  if (!readable) drawAxis(context, window, size, palette);
}

/** The whole run. */
export function wholeOf(run: Run, now: number): Window {
  const until = Math.max(run.ended ? run.until : now, 1e-3);
  return { from: 0, until: until * 1.02, top: 0, rowHeight: readableRow };
}
