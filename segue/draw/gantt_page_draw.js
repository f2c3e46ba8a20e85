// SPDX-License-Identifier: Apache-2.0
// Continues gantt_chart.js in the same module.
const run = JSON.parse(document.getElementById('run').textContent);
const KINDS = ['irreversible', 'pure', 'sensing'];
const STATUS = ['not reached', 'done', 'skipped', 'failed', 'preempted'];
const DONE = STATUS.indexOf('done'), FAILED = STATUS.indexOf('failed');
const WAITS = ['data', 'condition', 'world', 'resource', 'turn'];
const WAIT_TEXT = ['data', 'a condition', 'a precondition', 'a resource', 'program order'];
const PAGE = 500;

// A node: [name, kind, status, outcome, critical, ahead, waits, resources]; a wait: [kind, node or -1, subject, from,
// until]; a bar: [node, from, until, wasted].
const nodes = run.nodes.map(([name, kind, status, outcome, critical, ahead, waits, resources], id) =>
  ({id, name, kind, status, outcome, critical, ahead, resources, bars: [],
    waits: waits.map(([kind, node, subject, from, until]) => ({kind, node, subject, from, until}))}));
const bars = run.bars.map(([node, from, until, wasted]) => ({node: nodes[node], from, until, wasted}));
for (const bar of bars) bar.node.bars.push(bar);
const end = Math.max(run.makespan, bars.reduce((last, bar) => Math.max(last, bar.until), 0)) || 1;

const find = id => document.getElementById(id);
const make = (tag, text, parent, name) => {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (name) element.className = name;
  if (parent) parent.append(element);
  return element;
};
const plot = find('plot'), scroller = find('scroller'), overview = find('overview'), tip = find('tip');

const state = {rows: [], from: 0, until: end, selected: null, matches: [], matched: new Set(), dim: false};
let palette = {};
let size = {width: 0, height: 0, gutter: 120};

/// The window of time that is seen; the browser scrolls the rows.
const windowNow = () => ({from: state.from, until: state.until, top: scroller.scrollTop / readableRow, rowHeight: readableRow});

function seconds(value, room = end) {
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

/// The colours of the page as it is now: light or dark.
function readColours() {
  const style = getComputedStyle(document.documentElement);
  const colour = name => style.getPropertyValue('--' + name).trim();
  palette = {
    text: colour('text'), quiet: colour('soft'), line: colour('line'), grid: colour('grid'), back: colour('back'), front: colour('back'),
    onBar: colour('on-bar'), critical: colour('critical'), ahead: colour('ahead'), discarded: colour('wasted'),
    stripe: colour('stripe'), select: colour('select'), match: colour('match'), kinds: KINDS.map(colour), waits: WAITS.map(colour),
  };
}

/// The context of a canvas of that size, empty.
function prepare(canvas, width, height) {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  canvas.style.width = width + 'px';
  canvas.style.height = height + 'px';
  const context = canvas.getContext('2d');
  setUp(context, ratio);
  return context;
}

/// As wide as the longest labels, up to a share of the whole.
function gutterFor(width) {
  const context = plot.getContext('2d');
  setUp(context, 1);
  const longest = state.rows.reduce((most, row) => Math.max(most, row.label.length), 0);
  const sample = state.rows.filter(row => row.label.length >= longest * 0.8).slice(0, 200);
  const text = sample.reduce((most, row) => Math.max(most, context.measureText(row.label).width), 60);
  return Math.min(text + 30, width * 0.3);
}

function resize() {
  const wanted = axisHeight + Math.max(1, state.rows.length) * readableRow + 6;
  scroller.style.height = Math.min(wanted, Math.max(200, window.innerHeight * 0.62)) + 'px';
  size = {width: scroller.clientWidth, height: scroller.clientHeight, gutter: gutterFor(scroller.clientWidth)};
  find('space').style.height = Math.max(0, wanted - size.height) + 'px';
  draw();
}

function barLook(bar) {
  const node = bar.node;
  const outline = node === state.selected ? 2 : state.byResource && state.matched.has(node.id) ? 1 : 0;
  return {colour: palette.kinds[node.kind], discarded: bar.wasted, ahead: node.ahead, critical: node.critical,
    faint: state.dim && !node.critical, text: state.byResource ? node.name : '', outline};
}

const waitLook = wait => ({from: wait.from, until: wait.until, colour: palette.waits[wait.kind], because: ''});

function labelColour(node) {
  return node && node.status === FAILED ? palette.critical : node && node.status !== DONE ? palette.quiet : palette.text;
}

/// A row of a node, whose runs may overlap, or one of a resource, which has one user at a time.
function rowLook(index) {
  const {label, bars: own, node} = state.rows[index];
  return {label: {text: label, critical: node !== null && node.critical, colour: labelColour(node)},
    faint: node !== null && state.dim && !node.critical, waits: node ? node.waits.map(waitLook) : [],
    bars: own, inOrder: node === null, lookOf: barLook};
}

/// From the ends of those that the selected node waited for.
function reasonsOf(node) {
  const to = rowOf(node);
  if (to < 0 || !node.bars.some(bar => !bar.wasted)) return [];
  return node.waits.filter(wait => wait.node >= 0)
    .map(wait => ({time: wait.until, from: rowOf(nodes[wait.node]), to, colour: palette.waits[wait.kind]}))
    .filter(reason => reason.from >= 0 && reason.from !== to);
}

/// Every second row is shaded; what is selected or found is lit.
function drawBacks({context, window, size}) {
  const {first, last} = rowsSeen(window, size, state.rows.length);
  for (let i = first; i < last; ++i) {
    const node = state.rows[i].node;
    const isChosen = node !== null && node === state.selected;
    const isMatch = node !== null && state.matched.has(node.id);
    context.fillStyle = isChosen ? palette.select : isMatch ? palette.match : i % 2 ? palette.stripe : palette.back;
    context.fillRect(0, yOf(window, i), size.width, readableRow);
  }
}

let waiting = false;
function draw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; drawNow(); });
}

function drawNow() {
  const context = prepare(plot, size.width, size.height);
  const chart = {context, window: windowNow(), size, palette};
  context.fillStyle = palette.back;
  context.fillRect(0, 0, size.width, size.height);
  drawBacks(chart);
  drawAxis(chart);
  drawRows(chart, state.rows.length, rowLook);
  if (state.selected) drawReasons(chart, reasonsOf(state.selected));
  drawOverview();
}

// ---- the overview: how much ran at the same time ----

const profile = (() => {
  const bins = new Array(600).fill(0);
  for (const bar of bars) {
    const from = bar.from / end * bins.length, until = bar.until / end * bins.length;
    for (let i = Math.floor(from); i < Math.min(bins.length, until); ++i)
      bins[i] += Math.min(until, i + 1) - Math.max(from, i);
  }
  return {bins, most: Math.max(1, ...bins)};
})();

function drawOverview() {
  const height = 34, context = prepare(overview, size.width, height);
  const at = time => xOf({...windowNow(), from: 0, until: end}, size, time);
  context.fillStyle = palette.quiet;
  context.textAlign = 'left';
  context.fillText(fit(context, Math.round(profile.most) + ' at once', size.gutter - 16), 9, height / 2);
  context.fillStyle = palette.kinds[KINDS.indexOf('pure')];
  context.beginPath();
  context.moveTo(at(0), height);
  profile.bins.forEach((value, i) => {
    const top = height - value / profile.most * (height - 6), bin = end / profile.bins.length;
    context.lineTo(at(i * bin), top);
    context.lineTo(at((i + 1) * bin), top);
  });
  context.lineTo(at(end), height);
  context.fill();
  context.strokeStyle = palette.text;
  context.lineWidth = 1.5;
  const left = Math.max(1, at(state.from));
  context.strokeRect(left, 1, Math.min(Math.max(3, at(state.until) - left), size.width - 1 - left), height - 2);
}
