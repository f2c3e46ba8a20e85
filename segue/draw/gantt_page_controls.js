// SPDX-License-Identifier: Apache-2.0
// Continues gantt_page_draw.js in the same script.

// ---- moving ----

function showWindow(seen) {
  state.from = seen.from;
  state.until = seen.until;
  draw();
}
const pan = time => showWindow(moved(windowNow(), time, end));
const zoom = (factor, around = (state.from + state.until) / 2) => showWindow(zoomed(windowNow(), factor, around, end));
const everything = () => showWindow(wholeOf(end));
/// That much time from `from` on.
const showFrom = (from, length) => showWindow(zoomed({...windowNow(), from, until: from + length}, 1, from, end));

function reveal(node) {
  const row = rowOf(node);
  if (row < 0) return;
  const top = row * readableRow, room = size.height - axisHeight - readableRow;
  if (top < scroller.scrollTop) scroller.scrollTop = top;
  else if (top > scroller.scrollTop + room) scroller.scrollTop = top - room;
  const bar = node.bars[node.bars.length - 1];
  if (!bar || (bar.until >= state.from && bar.from <= state.until)) return;
  const length = state.until - state.from;
  showFrom(bar.from - length / 3, length);
}

function select(node) {
  state.selected = node;
  if (node) reveal(node);
  describe(node);
  draw();
}

// ---- what is told of a node ----

function waitText(wait) {
  const whom = wait.node >= 0 ? ' of ' + nodes[wait.node].name : '';
  return `${WAIT_TEXT[wait.kind]}${wait.subject ? ': ' + wait.subject : ''}${whom}, ${seconds(wait.from)} to ${seconds(wait.until)}`;
}

function runText(node) {
  const counted = node.bars.find(bar => !bar.wasted);
  const parts = [KINDS[node.kind], STATUS[node.status]];
  if (node.outcome && node.outcome !== 'success') parts.push('outcome ' + node.outcome);
  if (counted) parts.push(`${seconds(counted.from)} to ${seconds(counted.until)} (${seconds(counted.until - counted.from)})`);
  if (node.critical) parts.push('in the critical chain');
  if (node.ahead) parts.push('speculative, used');
  const wasted = node.bars.filter(bar => bar.wasted).length;
  if (wasted > 0) parts.push(`${wasted} run${wasted > 1 ? 's' : ''} discarded`);
  return parts.join(', ');
}

function describe(node) {
  const detail = find('detail');
  detail.replaceChildren();
  if (!node) {
    make('span', 'Select a node to see what it waited for.', detail, 'soft');
    return;
  }
  make('h2', node.name, detail);
  make('div', runText(node), detail);
  if (node.resources.length > 0)
    make('div', 'uses ' + node.resources.map(resource => run.resources[resource]).join(', '), detail, 'soft');
  const list = make('ul', undefined, detail);
  for (const wait of node.waits) {
    const item = make('li', undefined, list);
    make('i', undefined, item, 'kind thin').style.background = `var(--${WAITS[wait.kind]})`;
    make('span', ' waited for ' + waitText(wait) + ' ', item);
    if (wait.node < 0) continue;
    const go = make('button', 'go there', item);
    go.setAttribute('aria-label', 'go there: ' + nodes[wait.node].name);
    go.onclick = () => select(nodes[wait.node]);
  }
}

function hit(across, down) {
  const row = state.rows[rowAt(windowNow(), state.rows.length, down)];
  if (!row) return null;
  const time = timeAt(windowNow(), size, across), near = 3 * length() / (size.width - size.gutter);
  if (across < size.gutter) return {node: row.node, row};
  const bar = row.bars.find(one => time >= one.from - near && time <= one.until + near);
  if (bar) return {node: bar.node, bar, row};
  const wait = row.node && row.node.waits.find(one => time >= one.from && time <= one.until);
  return {node: row.node, wait, row};
}

function showTip(event, found) {
  const text = !found ? '' : found.wait ? `${found.node.name}\nwaits for ${waitText(found.wait)}`
    : found.bar && found.bar.wasted ? `${found.node.name}\ndiscarded run, ${seconds(found.bar.from)} to ${seconds(found.bar.until)}`
    : found.node ? [found.node.name, runText(found.node), ...found.node.waits.slice(-3).map(wait => 'waited for ' + waitText(wait))].join('\n')
    : found.row.label;
  tip.hidden = text === '';
  tip.textContent = text;
  const left = Math.min(event.clientX + 14, window.innerWidth - tip.offsetWidth - 8);
  const below = event.clientY + 18 + tip.offsetHeight < window.innerHeight;
  tip.style.left = Math.max(4, left) + 'px';
  tip.style.top = (below ? event.clientY + 18 : event.clientY - tip.offsetHeight - 10) + 'px';
}

// ---- pointer, wheel, keys ----

let drag = null;
plot.addEventListener('pointerdown', event => {
  drag = {x: event.clientX, y: event.clientY, seen: windowNow(), top: scroller.scrollTop, isMove: false};
  plot.setPointerCapture(event.pointerId);
  scroller.focus({preventScroll: true});
});
plot.addEventListener('pointermove', event => {
  if (!drag) return showTip(event, hit(event.offsetX, event.offsetY));
  drag.isMove = drag.isMove || Math.hypot(event.clientX - drag.x, event.clientY - drag.y) > 4;
  if (!drag.isMove) return;
  plot.classList.add('drag');
  tip.hidden = true;
  const time = (drag.x - event.clientX) / (size.width - size.gutter) * (drag.seen.until - drag.seen.from);
  showWindow(moved(drag.seen, time, end));
  scroller.scrollTop = drag.top + drag.y - event.clientY;
});
plot.addEventListener('pointerup', event => {
  const found = drag && !drag.isMove ? hit(event.offsetX, event.offsetY) : undefined;
  drag = null;
  plot.classList.remove('drag');
  if (found !== undefined) select(found ? found.node : null);
});
plot.addEventListener('pointercancel', () => { drag = null; });
plot.addEventListener('pointerleave', () => { tip.hidden = true; });
scroller.addEventListener('scroll', draw);
scroller.addEventListener('wheel', event => {
  const scale = event.deltaMode === 1 ? 18 : 1;
  if (event.ctrlKey || event.metaKey) {
    event.preventDefault();
    zoom(Math.exp(event.deltaY * scale * 0.002), timeAt(windowNow(), size, event.clientX - plot.getBoundingClientRect().left));
  } else if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
    event.preventDefault();
    const by = (event.shiftKey && event.deltaX === 0 ? event.deltaY : event.deltaX) * scale;
    pan(by / (size.width - size.gutter) * length());
  }
}, {passive: false});

function centreOverview(event) {
  const time = timeAt({...windowNow(), from: 0, until: end}, size, event.offsetX);
  showFrom(time - length() / 2, length());
}
overview.addEventListener('pointerdown', event => { overview.setPointerCapture(event.pointerId); centreOverview(event); });
overview.addEventListener('pointermove', event => { if (event.buttons) centreOverview(event); });

function step(by) {
  const at = state.selected ? state.selected.id + by : by > 0 ? 0 : nodes.length - 1;
  if (nodes[at]) select(nodes[at]);
}
function zoomToSelected() {
  const bar = state.selected && state.selected.bars[state.selected.bars.length - 1];
  if (!bar) return;
  const room = bar.until - bar.from + end * 1e-3;
  showFrom(bar.from - room, bar.until - bar.from + 2 * room);
}
function follow() {
  const waits = state.selected ? state.selected.waits : [];
  const wait = waits[waits.length - 1];
  if (wait && wait.node >= 0) select(nodes[wait.node]);
}
const length = () => state.until - state.from;
const keys = {
  'ArrowLeft': () => pan(-length() / 8), 'ArrowRight': () => pan(length() / 8),
  'ArrowUp': () => step(-1), 'ArrowDown': () => step(1),
  '+': () => zoom(0.7), '=': () => zoom(0.7), '-': () => zoom(1 / 0.7), '0': everything,
  'Home': () => showFrom(0, length()), 'End': () => showFrom(end - length(), length()),
  'Enter': zoomToSelected, 'w': follow, 'Escape': () => select(null),
};
scroller.addEventListener('keydown', event => {
  const action = keys[event.key];
  if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  action();
});
document.addEventListener('keydown', event => {
  if (event.key !== '/' || event.target.matches('input[type=search]')) return;
  event.preventDefault();
  find('search').focus();
});

// ---- tools ----

for (const radio of document.querySelectorAll('input[name=view]')) radio.onchange = () => show(radio.value);
find('in').onclick = () => zoom(0.6);
find('out').onclick = () => zoom(1 / 0.6);
find('fit').onclick = everything;
find('dim').onchange = event => { state.dim = event.target.checked; draw(); };

const search = find('search');
function findNodes(by) {
  if (state.matches.length === 0) return;
  const now = state.selected ? state.matches.indexOf(state.selected) : -1;
  const at = now < 0 ? (by > 0 ? 0 : state.matches.length - 1) : (now + by + state.matches.length) % state.matches.length;
  select(state.matches[at]);
  find('found').textContent = `${at + 1} of ${state.matches.length}`;
}
search.addEventListener('input', () => {
  const text = search.value.toLowerCase();
  state.matches = text === '' ? [] : nodes.filter(node => node.name.toLowerCase().includes(text));
  state.matched = new Set(state.matches.map(node => node.id));
  find('found').textContent = text === '' ? '' : state.matches.length === 0 ? 'none' : `${state.matches.length} found`;
  if (state.matches.length > 0 && !state.matched.has(state.selected && state.selected.id)) findNodes(1);
  draw();
});
search.addEventListener('keydown', event => {
  if (event.key === 'Enter') findNodes(event.shiftKey ? -1 : 1);
  if (event.key === 'Escape') scroller.focus();
});

// ---- the table ----

function row(parent, cells, tag) {
  const line = make('tr', undefined, parent);
  cells.forEach((cell, i) => {
    const own = make(tag, cell, line, i === 1 || i === 2 ? 'number' : i === 0 || i === 5 ? 'wide' : '');
    if (tag === 'th') own.scope = 'col';
  });
}

function fillTable(first) {
  const place = find('table');
  place.replaceChildren();
  const table = make('table', undefined, place);
  row(make('thead', undefined, table), ['node', 'start', 'end', 'kind', 'status', 'waited for', 'remarks'], 'th');
  const body = make('tbody', undefined, table);
  for (const node of nodes.slice(first, first + PAGE)) {
    const counted = node.bars.find(bar => !bar.wasted);
    const remarks = [node.critical ? 'critical' : '', node.ahead ? 'speculative' : '', node.bars.some(bar => bar.wasted) ? 'discarded runs' : ''];
    row(body, [node.name, counted ? seconds(counted.from) : '-', counted ? seconds(counted.until) : '-', KINDS[node.kind],
      STATUS[node.status], node.waits.map(waitText).join('; '), remarks.filter(text => text).join(', ')], 'td');
  }
  if (nodes.length <= PAGE) return;
  const pages = make('p', `${first + 1} to ${Math.min(first + PAGE, nodes.length)} of ${nodes.length} `, place);
  const turn = (text, to) => {
    const button = make('button', text, pages);
    button.disabled = to < 0 || to >= nodes.length;
    button.onclick = () => fillTable(to);
  };
  turn('before', first - PAGE);
  turn('after', first + PAGE);
}
find('list').addEventListener('toggle', () => { if (find('list').open) fillTable(0); });

// ---- the head ----

function compare() {
  const place = find('compare');
  const most = Math.max(run.sequential, run.makespan, run.critical_path) || 1;
  const line = (text, value, shade) => {
    const own = make('div', undefined, place);
    own.style.display = 'contents';
    own.setAttribute('role', 'row');
    make('span', text, own).setAttribute('role', 'rowheader');
    make('i', undefined, make('span', undefined, own)).style.cssText =
      `width:${value / most * 100}%;background:var(--${shade})`;
    make('b', seconds(value), own).setAttribute('role', 'cell');
  };
  line('sequential time', run.sequential, 'turn');
  line('this run', run.makespan, 'pure');
  line('critical path', run.critical_path, 'critical');
  if (run.makespan <= 0) return;
  const best = run.shortest > 0 ? `, at most ${(run.sequential / run.shortest).toFixed(2)}\u00d7 possible` : '';
  make('div', `speed-up ${(run.sequential / run.makespan).toFixed(2)}\u00d7${best}`, place).style.gridColumn = '1 / -1';
}

find('name').textContent = run.name || 'run';
const onPath = nodes.filter(node => ['done', 'failed', 'preempted'].includes(STATUS[node.status])).length;
find('outcome').textContent = `${run.outcome} in ${seconds(run.makespan)}, ${onPath} node${onPath === 1 ? '' : 's'}`;
const used = nodes.filter(node => node.ahead).length;
find('speculation').textContent = used + run.wasted > 0
  ? `speculative runs: ${used} used, ${run.wasted} discarded` + (run.repeated > 0 ? `, ${run.repeated} repeated` : '') : 'no speculative runs';
compare();
readColours();
describe(null);
window.addEventListener('resize', resize);
window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { readColours(); draw(); });
state.until = wholeOf(end).until;
show('nodes');
