// SPDX-License-Identifier: Apache-2.0
'use strict';
const run = JSON.parse(document.getElementById('run').textContent);
const KINDS = ['irreversible', 'pure', 'sensing'];
const STATUS = ['not reached', 'done', 'skipped', 'failed', 'preempted'];
const WAITS = ['data', 'condition', 'world', 'resource', 'turn'];
const WAIT_TEXT = ['data', 'a condition', 'a precondition', 'a resource', 'program order'];
const ROW = 22, AXIS = 24, PAGE = 500;

// A node: [name, kind, status, outcome, critical, ahead, waits, resources]; a wait: [kind, node or -1, subject, from,
// until]; a bar: [node, from, until, wasted].
const nodes = run.nodes.map(([name, kind, status, outcome, critical, ahead, waits, resources], id) =>
  ({id, name, kind, status, outcome, critical, ahead, resources, bars: [],
    waits: waits.map(([kind, node, subject, from, until]) => ({kind, node, subject, from, until}))}));
const bars = run.bars.map(([node, from, until, wasted]) => ({node: nodes[node], from, until, wasted}));
for (const bar of bars) bar.node.bars.push(bar);
const span = Math.max(run.makespan, bars.reduce((last, bar) => Math.max(last, bar.until), 0)) || 1;

const find = id => document.getElementById(id);
const make = (tag, text, parent, name) => {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (name) element.className = name;
  if (parent) parent.append(element);
  return element;
};
const plot = find('plot'), scroller = find('scroller'), overview = find('overview'), tip = find('tip');

const state = {rows: [], from: 0, until: span, selected: null, hover: null, matches: [], matched: new Set(), dim: false};
let colour = {};
let gutter = 120, width = 0, height = 0;

function seconds(value, room = span) {
  const digits = room >= 1000 ? 1 : room >= 10 ? 2 : room >= 0.1 ? 3 : 6;
  return value.toFixed(digits) + ' s';
}

// ---- rows ----

/// Bars that overlap get rows of their own, below the first.
function lanes(label, own) {
  const rows = [], free = [];
  for (const bar of own) {
    let lane = free.findIndex(until => until <= bar.from);
    if (lane < 0) {
      lane = free.push(0) - 1;
      rows.push({label: lane === 0 ? label : '', bars: [], node: null});
    }
    free[lane] = bar.until;
    rows[lane].bars.push(bar);
  }
  return rows.length > 0 ? rows : [{label, bars: [], node: null}];
}

function rowsByResource() {
  const own = run.resources.map(() => []);
  for (const bar of bars)
    for (const resource of bar.node.resources) own[resource].push(bar);
  return run.resources.flatMap((name, resource) => lanes(name, own[resource]));
}

function show(view) {
  state.rows = view === 'resources' ? rowsByResource()
                                    : nodes.map(node => ({label: node.name, bars: node.bars, node}));
  state.byResource = view === 'resources';
  scroller.scrollTop = 0;
  resize();
}

/// The row that shows a node.
function rowOf(node) {
  return state.byResource ? state.rows.findIndex(row => row.bars.some(bar => bar.node === node)) : node.id;
}

// ---- drawing ----

function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ['back', 'line', 'grid', 'text', 'soft', 'stripe', 'select', 'match', 'on-bar', 'critical', 'ahead', 'wasted',
    ...KINDS, ...WAITS]) colour[name] = style.getPropertyValue('--' + name).trim();
}

function prepare(canvas, across, down) {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(across * ratio);
  canvas.height = Math.round(down * ratio);
  canvas.style.width = across + 'px';
  canvas.style.height = down + 'px';
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.font = '12px system-ui, "Segoe UI", "DejaVu Sans", sans-serif';
  context.textBaseline = 'middle';
  return context;
}

function resize() {
  const wanted = AXIS + Math.max(1, state.rows.length) * ROW + 6;
  scroller.style.height = Math.min(wanted, Math.max(200, window.innerHeight * 0.62)) + 'px';
  width = scroller.clientWidth;
  height = scroller.clientHeight;
  const context = plot.getContext('2d');
  context.font = '12px system-ui, "Segoe UI", "DejaVu Sans", sans-serif';
  let longest = 0;
  for (const row of state.rows) longest = Math.max(longest, row.label.length);
  const sample = state.rows.filter(row => row.label.length >= longest * 0.8).slice(0, 200);
  const text = sample.reduce((most, row) => Math.max(most, context.measureText(row.label).width), 60);
  gutter = Math.min(text + 20, width * 0.3);
  find('space').style.height = Math.max(0, wanted - height) + 'px';
  draw();
}

const x = time => gutter + (time - state.from) / (state.until - state.from) * (width - gutter - 8);
const timeAt = across => state.from + (across - gutter) / (width - gutter - 8) * (state.until - state.from);

function steps() {
  const rough = (state.until - state.from) / Math.max(2, (width - gutter) / 90);
  const unit = 10 ** Math.floor(Math.log10(rough));
  const step = unit * [1, 2, 5, 10].find(factor => factor * unit >= rough);
  const first = Math.ceil(state.from / step - 1e-9);
  const times = [];
  for (let i = first; i * step <= state.until + step * 1e-9; ++i) times.push(i * step);
  return {times, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9))};
}

/* Shortened at its begin so that it fits: what a path ends with tells more. */
function fit(context, text, room) {
  if (context.measureText(text).width <= room) return text;
  const characters = [...text];
  let low = 0, high = characters.length;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (context.measureText('\u2026' + characters.slice(-middle).join('')).width <= room) low = middle;
    else high = middle - 1;
  }
  return low > 0 ? '\u2026' + characters.slice(-low).join('') : '';
}

function drawAxis(context) {
  const {times, digits} = steps();
  context.fillStyle = colour.soft;
  context.textAlign = 'center';
  for (const time of times) {
    const text = time.toFixed(digits) + ' s';
    const half = context.measureText(text).width / 2;
    if (x(time) + half <= width) context.fillText(text, Math.max(x(time), gutter + half), AXIS / 2);
  }
  context.fillStyle = colour.line;
  context.fillRect(0, AXIS - 1, width, 1);
}

function drawGrid(context) {
  context.fillStyle = colour.grid;
  for (const time of steps().times) context.fillRect(Math.round(x(time)), AXIS, 1, height);
}

function hatch(context, left, top, across, down) {
  context.save();
  context.beginPath();
  context.rect(left, top, across, down);
  context.clip();
  context.strokeStyle = colour.wasted;
  context.lineWidth = 1.5;
  context.beginPath();
  for (let at = left - down; at < left + across; at += 6) {
    context.moveTo(at, top + down);
    context.lineTo(at + down, top);
  }
  context.stroke();
  context.restore();
  context.strokeStyle = colour.wasted;
  context.lineWidth = 1;
  context.setLineDash([3, 2]);
  context.strokeRect(left + 0.5, top + 0.5, Math.max(1, across - 1), down - 1);
  context.setLineDash([]);
}

function drawBar(context, bar, top, left, right) {
  const across = Math.max(1.5, right - left), node = bar.node;
  if (bar.wasted) return hatch(context, left, top + 4, across, ROW - 8);
  context.globalAlpha = state.dim && !node.critical ? 0.25 : 1;
  context.fillStyle = colour[KINDS[node.kind]];
  context.fillRect(left, top + 4, across, ROW - 8);
  if (node.ahead) {
    context.fillStyle = colour.ahead;
    context.fillRect(left, top + ROW - 4, across, 3);
  }
  if (node.critical) {
    context.fillStyle = context.strokeStyle = colour.critical;
    context.lineWidth = 2;
    if (across > 6) context.strokeRect(left, top + 4, across, ROW - 8);
    else for (const edge of [top + 3, top + ROW - 5]) context.fillRect(left, edge, across, 2);
  }
  if (state.byResource && across > 26) {
    context.fillStyle = colour['on-bar'];
    context.textAlign = 'left';
    context.fillText(fit(context, node.name, across - 8), left + 4, top + ROW / 2);
  }
  context.globalAlpha = 1;
  if (node === state.selected || (state.byResource && state.matched.has(node.id))) {
    context.strokeStyle = colour.text;
    context.lineWidth = node === state.selected ? 2 : 1;
    context.strokeRect(left - 2, top + 2, across + 4, ROW - 4);
  }
}

function firstVisible(own) {
  let low = 0, high = own.length;  // by start; what began before and still runs is at most one in a row
  while (low < high) {
    const middle = (low + high) >> 1;
    if (own[middle].until < state.from) low = middle + 1;
    else high = middle;
  }
  return low;
}

function drawBars(context, row, top) {
  const ordered = row.node === null;
  let painted = -1;
  for (let i = ordered ? firstVisible(row.bars) : 0; i < row.bars.length; ++i) {
    const bar = row.bars[i];
    if (ordered && bar.from > state.until) break;
    if (bar.until < state.from || bar.from > state.until) continue;
    const left = Math.max(gutter - 3, x(bar.from)), right = Math.min(width + 3, x(bar.until));
    if (ordered && right < painted + 0.5) continue;  // thinner than can be seen
    painted = right;
    drawBar(context, bar, top, left, right);
  }
}

function drawWaits(context, node, top) {
  context.globalAlpha = state.dim && !node.critical ? 0.2 : 1;
  for (const wait of node.waits) {
    if (wait.until < state.from || wait.from > state.until) continue;
    const left = Math.max(gutter, x(wait.from)), right = Math.min(width, x(wait.until));
    context.fillStyle = colour[WAITS[wait.kind]];
    context.fillRect(left, top + ROW / 2 - 2, Math.max(1, right - left), 4);
  }
  context.globalAlpha = 1;
}

/// From the ends of those it waited for.
function drawReasons(context, node) {
  const to = rowOf(node);
  const start = node.bars.find(bar => !bar.wasted);
  if (to < 0 || !start) return;
  const middle = row => AXIS + row * ROW - scroller.scrollTop + ROW / 2;
  context.lineWidth = 1.5;
  for (const wait of node.waits) {
    const other = nodes[wait.node];
    const from = other ? rowOf(other) : -1;
    if (from < 0 || from === to) continue;
    context.strokeStyle = colour[WAITS[wait.kind]];
    context.beginPath();
    context.moveTo(x(wait.until), middle(from));
    context.lineTo(x(wait.until), middle(to));
    context.stroke();
  }
}

function drawLabel(context, row, top) {
  const node = row.node;
  context.textAlign = 'left';
  context.fillStyle = node && node.status === 3 ? colour.critical : node && node.status !== 1 ? colour.soft : colour.text;
  if (node && node.critical) {
    context.save();
    context.fillStyle = colour.critical;
    context.fillRect(2, top + 4, 3, ROW - 8);
    context.restore();
  }
  context.fillText(fit(context, row.label, gutter - 16), 9, top + ROW / 2);
}

function drawRows(context, part) {
  const first = Math.max(0, Math.floor(scroller.scrollTop / ROW));
  const last = Math.min(state.rows.length, Math.ceil((scroller.scrollTop + height - AXIS) / ROW) + 1);
  for (let i = first; i < last; ++i) part(state.rows[i], AXIS + i * ROW - scroller.scrollTop, i);
}

let waiting = false;
function draw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; drawNow(); });
}

function drawNow() {
  const context = prepare(plot, width, height);
  context.fillStyle = colour.back;
  context.fillRect(0, 0, width, height);
  context.save();
  context.beginPath();
  context.rect(0, AXIS, width, height);
  context.clip();
  drawRows(context, (row, top, i) => {
    const chosen = state.selected !== null && (row.node === state.selected);
    const match = row.node && state.matched.has(row.node.id);
    context.fillStyle = chosen ? colour.select : match ? colour.match : i % 2 ? colour.stripe : colour.back;
    context.fillRect(0, top, width, ROW);
  });
  drawGrid(context);
  context.save();
  context.beginPath();
  context.rect(gutter - 3, AXIS, width, height);
  context.clip();
  drawRows(context, (row, top) => {
    if (row.node) drawWaits(context, row.node, top);
    drawBars(context, row, top);
  });
  if (state.selected) drawReasons(context, state.selected);
  context.restore();
  drawRows(context, (row, top) => drawLabel(context, row, top));
  context.restore();
  drawAxis(context);
  drawOverview();
}

// ---- the overview: how much ran at the same time ----

const profile = (() => {
  const bins = new Array(600).fill(0);
  for (const bar of bars) {
    const from = bar.from / span * bins.length, until = bar.until / span * bins.length;
    for (let i = Math.floor(from); i < Math.min(bins.length, until); ++i)
      bins[i] += Math.min(until, i + 1) - Math.max(from, i);
  }
  return {bins, most: Math.max(1, ...bins)};
})();

function drawOverview() {
  const down = 34, context = prepare(overview, width, down);
  const at = time => gutter + time / span * (width - gutter - 8);
  context.fillStyle = colour.soft;
  context.textAlign = 'left';
  context.fillText(fit(context, Math.round(profile.most) + ' at once', gutter - 16), 9, down / 2);
  context.fillStyle = colour.pure;
  context.beginPath();
  context.moveTo(at(0), down);
  profile.bins.forEach((value, i) => {
    const tall = down - value / profile.most * (down - 6), bin = span / profile.bins.length;
    context.lineTo(at(i * bin), tall);
    context.lineTo(at((i + 1) * bin), tall);
  });
  context.lineTo(at(span), down);
  context.fill();
  context.strokeStyle = colour.text;
  context.lineWidth = 1.5;
  context.strokeRect(at(state.from), 1, Math.min(Math.max(3, at(state.until) - at(state.from)), width - 1 - at(state.from)), down - 2);
}
