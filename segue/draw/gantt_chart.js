// SPDX-License-Identifier: Apache-2.0
// The parts that both Gantt charts have in common: that of the page which the command writes (gantt_page_*.js) and that of the
// studio (ui/src/missions). Times in seconds and rows become places on a canvas, and bars, waits, labels and the axis are
// drawn there. What rows, bars and colours mean is left to the charts. A module without imports: the build puts it before
// the script of the page, and the studio imports it, where TypeScript checks its types.

/**
 * The part of a run that is seen. `top`: the first row that is seen, in rows.
 * @typedef {{from: number, until: number, top: number, rowHeight: number}} Window
 */
/**
 * Of the canvas, in pixels; the gutter at its left has the labels.
 * @typedef {{width: number, height: number, gutter: number}} Size
 */
/** @typedef {{text: string, quiet: string, line: string, grid: string, back: string, front: string, onBar: string, critical: string, ahead: string, discarded: string}} Palette */
/** @typedef {{context: CanvasRenderingContext2D, window: Window, size: Size, palette: Palette}} Chart */
/**
 * How a bar looks. `ahead`: it began before it was certain to count, and does; `text`: written on it where there is room;
 * `outline`: the width of a line around it, 0 for none.
 * @typedef {{colour: string, discarded: boolean, ahead: boolean, critical: boolean, faint: boolean, text: string, outline: number}} BarLook
 */
/**
 * A wait of a row, with why where that is written on it.
 * @typedef {{from: number, until: number, colour: string, because: string}} WaitLook
 */
/** @typedef {{text: string, colour: string, critical: boolean}} LabelLook */
/**
 * The contents of a row: bars in order, each of which ends before the next begins, may be very many.
 * @template {{from: number, until: number}} Bar
 * @typedef {{label: LabelLook, faint: boolean, waits: readonly WaitLook[], bars: readonly Bar[], inOrder: boolean, lookOf: (bar: Bar) => BarLook}} RowLook
 */
/**
 * From a row that was waited for to the one that waited, at the time when the wait ended.
 * @typedef {{time: number, from: number, to: number, colour: string}} Reason
 */

/** Measures, in pixels. */
export const axisHeight = 24;
export const readableRow = 20;
const waitHeight = 4;
const thinnestBar = 1.5;
/** Narrower bars have no text, and shorter waits no reason. */
const readableText = 26;
const readableReason = 70;
const betweenTicks = 90;
/** How far zooming goes, in seconds and in shares of the run. */
const shortestWindow = 1e-6;
const longestWindow = 1.05;

// ---- times and rows ----

/** @param {Window} window @param {Size} size @param {number} time */
export function xOf(window, size, time) {
  return size.gutter + ((time - window.from) / (window.until - window.from)) * (size.width - size.gutter);
}

/** @param {Window} window @param {Size} size @param {number} x */
export function timeAt(window, size, x) {
  return window.from + ((x - size.gutter) / (size.width - size.gutter)) * (window.until - window.from);
}

/** @param {Window} window @param {number} row */
export function yOf(window, row) {
  return axisHeight + (row - window.top) * window.rowHeight;
}

/**
 * -1: none.
 * @param {Window} window @param {number} rows @param {number} y
 */
export function rowAt(window, rows, y) {
  const row = Math.floor(window.top + (y - axisHeight) / window.rowHeight);
  return y >= axisHeight && row >= 0 && row < rows ? row : -1;
}

/**
 * The rows that are seen, the last one excluded.
 * @param {Window} window @param {Size} size @param {number} rows
 */
export function rowsSeen(window, size, rows) {
  const last = Math.ceil(window.top + (size.height - axisHeight) / window.rowHeight);
  return { first: Math.max(0, Math.floor(window.top)), last: Math.min(rows, last) };
}

/**
 * The whole of a run that lasts until `end`.
 * @param {number} end @returns {Window}
 */
export function wholeOf(end) {
  return { from: 0, until: Math.max(end, shortestWindow) * 1.02, top: 0, rowHeight: readableRow };
}

/**
 * Moved in time, but not away from the run.
 * @param {Window} window @param {number} by @param {number} end @returns {Window}
 */
export function moved(window, by, end) {
  const span = window.until - window.from;
  const from = Math.min(Math.max(window.from + by, -0.02 * span), Math.max(end * 1.03 - span, -0.02 * span));
  return { ...window, from, until: from + span };
}

/**
 * Zoomed in time by a factor, with the time at `around` where it is; within a little more than the run.
 * @param {Window} window @param {number} factor @param {number} around @param {number} end @returns {Window}
 */
export function zoomed(window, factor, around, end) {
  const most = Math.max(end, shortestWindow) * longestWindow;
  const span = Math.min(Math.max((window.until - window.from) * factor, shortestWindow), most);
  const share = (around - window.from) / (window.until - window.from);
  return moved({ ...window, from: around - share * span, until: around + (1 - share) * span }, 0, end);
}

/**
 * A round length of time, of which the window has that many at the most.
 * @param {number} from @param {number} until @param {number} most
 */
function stepOf(from, until, most) {
  const rough = (until - from) / Math.max(1, most);
  const unit = 10 ** Math.floor(Math.log10(rough));
  return unit * ([1, 2, 5, 10].find((factor) => factor * unit >= rough) ?? 10);
}

/**
 * Round times for the axis, and with how many digits behind the point.
 * @param {number} from @param {number} until @param {number} most
 */
export function ticksOf(from, until, most) {
  const step = stepOf(from, until, most);
  const times = [];
  for (let i = Math.ceil(from / step - 1e-9) + 0; i * step <= until + step * 1e-9; ++i) times.push(i * step);
  return { times, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

// ---- drawing ----

/** @param {CanvasRenderingContext2D} context @param {number} ratio of pixels of the screen to those of the page */
export function setUp(context, ratio) {
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.font = '12px system-ui, "Segoe UI", "DejaVu Sans", sans-serif';
  context.textBaseline = 'middle';
}

/**
 * Clips: drawings until the context is restored stay right of `left` and below the axis.
 * @param {Chart} chart @param {number} left
 */
function clipRows({ context, size }, left) {
  context.save();
  context.beginPath();
  context.rect(left, axisHeight, size.width - left, size.height - axisHeight);
  context.clip();
}

/**
 * Shortened at its begin so that it fits: what a path ends with tells more.
 * @param {CanvasRenderingContext2D} context @param {string} text @param {number} room
 */
export function fit(context, text, room) {
  if (context.measureText(text).width <= room) return text;
  const characters = [...text];
  let low = 0;
  let high = characters.length;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (context.measureText('…' + characters.slice(-middle).join('')).width <= room) low = middle;
    else high = middle - 1;
  }
  return low > 0 ? '…' + characters.slice(-low).join('') : '';
}

/**
 * The times above, and a line down from each.
 * @param {Chart} chart
 */
export function drawAxis({ context, window, size, palette }) {
  const { times, digits } = ticksOf(window.from, window.until, (size.width - size.gutter) / betweenTicks);
  context.fillStyle = palette.back;
  context.fillRect(0, 0, size.width, axisHeight);
  context.textAlign = 'center';
  for (const time of times) {
    const x = xOf(window, size, time);
    const text = time.toFixed(digits) + ' s';
    const half = context.measureText(text).width / 2;
    context.fillStyle = palette.quiet;
    if (x + half <= size.width) context.fillText(text, Math.max(x, size.gutter + half), axisHeight / 2);
    context.fillStyle = palette.grid;
    context.fillRect(Math.round(x), axisHeight, 1, size.height);
  }
  context.fillStyle = palette.line;
  context.fillRect(0, axisHeight - 1, size.width, 1);
}

/** @param {Chart} chart @param {number} left @param {number} top @param {number} width @param {number} height */
function drawDiscarded({ context, palette }, left, top, width, height) {
  context.save();
  context.beginPath();
  context.rect(left, top, width, height);
  context.clip();
  context.strokeStyle = palette.discarded;
  context.lineWidth = 1.5;
  context.beginPath();
  for (let at = left - height; at < left + width; at += 6) {
    context.moveTo(at, top + height);
    context.lineTo(at + height, top);
  }
  context.stroke();
  context.restore();
  context.strokeStyle = palette.discarded;
  context.lineWidth = 1;
  context.setLineDash([3, 2]);
  context.strokeRect(left + 0.5, top + 0.5, Math.max(1, width - 1), height - 1);
  context.setLineDash([]);
}

/**
 * Part of the critical path: a frame; of a thin bar, lines above and below.
 * @param {Chart} chart @param {number} left @param {number} top @param {number} width @param {number} height
 */
function drawFrame({ context, palette }, left, top, width, height) {
  context.fillStyle = context.strokeStyle = palette.critical;
  context.lineWidth = 2;
  if (width > 6) context.strokeRect(left, top, width, height);
  else for (const edge of [top - 1, top + height - 1]) context.fillRect(left, edge, width, 2);
}

/** @param {Chart} chart @param {BarLook} look @param {number} rowTop @param {number} left @param {number} right */
function drawBar(chart, look, rowTop, left, right) {
  const { context, window, palette } = chart;
  const width = Math.max(thinnestBar, right - left);
  const inset = Math.min(4, window.rowHeight / 5);
  const [top, height] = [rowTop + inset, window.rowHeight - 2 * inset];
  context.globalAlpha = look.faint ? 0.25 : 1;
  context.fillStyle = look.colour;
  if (look.discarded) drawDiscarded(chart, left, top, width, height);
  else context.fillRect(left, top, width, height);
  context.fillStyle = palette.ahead;
  if (look.ahead && !look.discarded) context.fillRect(left, top + height, width, 3);
  if (look.critical && !look.discarded) drawFrame(chart, left, top, width, height);
  if (look.text !== '' && width > readableText) {
    context.fillStyle = palette.onBar;
    context.textAlign = 'left';
    context.fillText(fit(context, look.text, width - 8), left + 4, rowTop + window.rowHeight / 2);
  }
  context.globalAlpha = 1;
  if (look.outline === 0) return;
  context.strokeStyle = palette.text;
  context.lineWidth = look.outline;
  context.strokeRect(left - 2, top - 2, width + 4, height + 4);
}

/**
 * The first of bars in their order that ends within the window or after it.
 * @param {Window} window @param {readonly {until: number}[]} bars
 */
function firstSeen(window, bars) {
  let low = 0;
  let high = bars.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((bars[middle]?.until ?? 0) < window.from) low = middle + 1;
    else high = middle;
  }
  return low;
}

/**
 * Of bars in order those too thin to be seen beside others are left out.
 * @template {{from: number, until: number}} Bar
 * @param {Chart} chart @param {RowLook<Bar>} look @param {number} row
 */
function drawBars(chart, { bars, inOrder, lookOf }, row) {
  const { window, size } = chart;
  let painted = -1;
  for (let at = inOrder ? firstSeen(window, bars) : 0; at < bars.length; ++at) {
    const bar = /** @type {Bar} */ (bars[at]);
    if (inOrder && bar.from > window.until) break;
    if (bar.until < window.from || bar.from > window.until) continue;
    const left = Math.max(size.gutter - 3, xOf(window, size, bar.from));
    const right = Math.min(size.width + 3, xOf(window, size, bar.until));
    if (inOrder && right < painted + 0.5) continue;
    painted = right;
    drawBar(chart, lookOf(bar), yOf(window, row), left, right);
  }
}

/**
 * On the line of a wait, where there is room for it.
 * @param {Chart} chart @param {string} because @param {number} left @param {number} middle @param {number} room
 */
function writeReason({ context, palette }, because, left, middle, room) {
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

/** @param {Chart} chart @param {readonly WaitLook[]} waits @param {number} row @param {boolean} faint */
function drawWaits(chart, waits, row, faint) {
  const { context, window, size } = chart;
  const middle = yOf(window, row) + window.rowHeight / 2;
  context.globalAlpha = faint ? 0.25 : 1;
  for (const wait of waits) {
    if (wait.until <= wait.from || wait.until < window.from || wait.from > window.until) continue;
    const left = Math.max(size.gutter, xOf(window, size, wait.from));
    const right = Math.min(size.width, xOf(window, size, wait.until));
    context.fillStyle = wait.colour;
    context.fillRect(left, middle - waitHeight / 2, Math.max(1, right - left), waitHeight);
    if (wait.because !== '') writeReason(chart, wait.because, left + 14, middle, right - left - 28);
  }
  context.globalAlpha = 1;
}

/** @param {Chart} chart @param {LabelLook} label @param {number} row @param {boolean} faint */
function drawLabel({ context, window, size }, label, row, faint) {
  context.globalAlpha = faint ? 0.25 : 1;
  context.textAlign = 'left';
  context.fillStyle = label.colour;
  const text = (label.critical ? '◆ ' : '') + label.text;
  context.fillText(fit(context, text, size.gutter - 16), 9, yOf(window, row) + window.rowHeight / 2);
  context.globalAlpha = 1;
}

/**
 * The rows that are seen.
 * @template {{from: number, until: number}} Bar
 * @param {Chart} chart @param {number} rows @param {(row: number) => RowLook<Bar>} lookOf
 */
export function drawRows(chart, rows, lookOf) {
  const { first, last } = rowsSeen(chart.window, chart.size, rows);
  const looks = Array.from({ length: Math.max(0, last - first) }, (_, at) => lookOf(first + at));
  clipRows(chart, chart.size.gutter - 3);
  looks.forEach((look, at) => {
    drawWaits(chart, look.waits, first + at, look.faint);
    drawBars(chart, look, first + at);
  });
  chart.context.restore();
  clipRows(chart, 0);
  looks.forEach((look, at) => drawLabel(chart, look.label, first + at, look.faint));
  chart.context.restore();
}

/** @param {Chart} chart @param {readonly Reason[]} reasons */
export function drawReasons(chart, reasons) {
  const { context, window, size } = chart;
  clipRows(chart, size.gutter - 3);
  context.lineWidth = 1.5;
  for (const { time, from, to, colour } of reasons) {
    const x = xOf(window, size, time);
    context.strokeStyle = colour;
    context.beginPath();
    context.moveTo(x, yOf(window, from) + window.rowHeight / 2);
    context.lineTo(x, yOf(window, to) + window.rowHeight / 2);
    context.stroke();
  }
  context.restore();
}
