// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useRef, useState, type KeyboardEvent, type PointerEvent, type ReactNode } from 'react';
import { axisHeight, Bars, drawChart, moved, paletteOf, readableRow, rowAt, thinRow, timeAt, wholeOf, xOf, yOf, zoomed, type Palette, type Size, type Window } from './gantt';
import type { Run } from './run';

const refreshPause = 100;

function nowOf(run: Run): number {
  return run.ended || run.began === null ? run.until : Math.max(run.until, Date.now() / 1000 - run.began);
}

interface Props {
  run: Run;
  selected: number;
  onSelect: (row: number) => void;
  children?: ReactNode;
}

/** A run on a canvas. The visible part follows a run that goes on, until somebody zooms or moves it. */
export function GanttChart({ run, selected, onSelect, children }: Props) {
  const place = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const palette = useRef<Palette | null>(null);
  const held = useRef<Window | null>(null);
  const size = useRef<Size>({ width: 600, height: 300, gutter: 150 });
  const drag = useRef<{ x: number; y: number; window: Window; moved: boolean } | null>(null);
  const pending = useRef(false);
  const [words, setWords] = useState('');
  const [onlyCritical, setOnlyCritical] = useState(false);
  const bars = useMemo(() => new Bars(run.rows), [run]);
  const found = useMemo(() => {
    const wanted = words.trim().toLowerCase();
    if (wanted === '') return null;
    return new Set(run.rows.flatMap((row, index) => ((row.label + ' ' + row.status).toLowerCase().includes(wanted) ? [index] : [])));
  }, [run, words]);

  const seen = useRef({ run, bars, selected, found, onlyCritical });
  seen.current = { run, bars, selected, found, onlyCritical };

  const windowNow = (): Window => {
    const now = nowOf(seen.current.run);
    const window = held.current ?? wholeOf(seen.current.run, now);
    const room = size.current.height - axisHeight;
    const most = Math.max(0, seen.current.run.rows.length - room / window.rowHeight);
    return { ...window, top: Math.min(Math.max(0, window.top), most) };
  };

  const draw = useRef(() => {
    if (pending.current) return;
    pending.current = true;
    requestAnimationFrame(() => {
      pending.current = false;
      const context = canvas.current?.getContext('2d');
      if (!context || !canvas.current || !place.current) return;
      palette.current ??= paletteOf(place.current);
      const { run: shown, bars: all, selected: chosen, found: matches, onlyCritical: critical } = seen.current;
      const ratio = globalThis.devicePixelRatio || 1;
      const marks = { selected: chosen, found: matches, onlyCritical: critical };
      drawChart(context, all, windowNow(), size.current, palette.current, marks, nowOf(shown), ratio);
    });
  });
  const show = (window: Window | null) => {
    held.current = window;
    draw.current();
  };

  useEffect(() => {
    const holder = place.current;
    const target = canvas.current;
    if (!holder || !target) return;
    const measure = () => {
      const ratio = globalThis.devicePixelRatio || 1;
      const width = holder.clientWidth;
      const height = holder.clientHeight;
      size.current = { width, height, gutter: Math.min(210, width * 0.3) };
      target.width = Math.round(width * ratio);
      target.height = Math.round(height * ratio);
      draw.current();
    };
    const watch = new ResizeObserver(measure);
    watch.observe(holder);
    const dark = matchMedia('(prefers-color-scheme: dark)');
    const repaint = () => {
      palette.current = null;
      draw.current();
    };
    dark.addEventListener('change', repaint);
    // The listener is not one of React, whose listeners cannot keep the page from zooming.
    const turn = (event: WheelEvent) => {
      event.preventDefault();
      const window = windowNow();
      const end = nowOf(seen.current.run);
      const x = event.clientX - target.getBoundingClientRect().left;
      if (event.ctrlKey || event.metaKey) show(zoomed(window, Math.exp(event.deltaY * 0.002), timeAt(window, size.current, Math.max(x, size.current.gutter)), end));
      else if (event.shiftKey || event.deltaX !== 0) show(moved(window, ((event.deltaX || event.deltaY) / size.current.width) * (window.until - window.from), end));
      else show({ ...window, top: window.top + event.deltaY / window.rowHeight });
    };
    target.addEventListener('wheel', turn, { passive: false });
    return () => {
      watch.disconnect();
      dark.removeEventListener('change', repaint);
      target.removeEventListener('wheel', turn);
    };
    // The functions look at references only.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, []);

  useEffect(() => draw.current(), [bars, selected, found, onlyCritical]);
  useEffect(() => {
    if (run.ended) return;
    const timer = setInterval(() => draw.current(), refreshPause);
    return () => clearInterval(timer);
  }, [run.ended]);
  useEffect(() => show(null), [run.name, run.began]); // eslint-disable-line react-hooks/exhaustive-deps

  const choose = (row: number) => {
    onSelect(row);
    const window = windowNow();
    const y = yOf(window, row);
    if (row >= 0 && (y < axisHeight || y + window.rowHeight > size.current.height))
      show({ ...window, top: row - (size.current.height - axisHeight) / window.rowHeight / 2 });
  };

  const fitRows = () => {
    const window = windowNow();
    const room = size.current.height - axisHeight;
    const all = room / Math.max(1, run.rows.length);
    show({ ...window, top: 0, rowHeight: window.rowHeight >= thinRow && all < readableRow ? all : readableRow });
  };

  const press = (event: KeyboardEvent) => {
    const window = windowNow();
    const end = nowOf(run);
    const step = (window.until - window.from) / 10;
    const middle = (window.from + window.until) / 2;
    const rows = run.rows.length;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => show(moved(window, -step, end)),
      ArrowRight: () => show(moved(window, step, end)),
      ArrowUp: () => choose(Math.max(0, selected - 1)),
      ArrowDown: () => choose(Math.min(rows - 1, selected + 1)),
      PageUp: () => show({ ...window, top: window.top - (size.current.height - axisHeight) / window.rowHeight }),
      PageDown: () => show({ ...window, top: window.top + (size.current.height - axisHeight) / window.rowHeight }),
      Home: () => show(null),
      '+': () => show(zoomed(window, 0.7, middle, end)),
      '-': () => show(zoomed(window, 1 / 0.7, middle, end)),
      Escape: () => onSelect(-1),
    };
    const action = actions[event.key];
    if (!action || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    action();
  };

  const down = (event: PointerEvent) => {
    drag.current = { x: event.clientX, y: event.clientY, window: windowNow(), moved: false };
    event.currentTarget.setPointerCapture(event.pointerId);
  };
  const move = (event: PointerEvent) => {
    const begun = drag.current;
    if (!begun) return;
    const x = event.clientX - begun.x;
    const y = event.clientY - begun.y;
    if (!begun.moved && Math.abs(x) + Math.abs(y) < 4) return;
    begun.moved = true;
    const span = begun.window.until - begun.window.from;
    const window = moved(begun.window, (-x / (size.current.width - size.current.gutter)) * span, nowOf(run));
    show({ ...window, top: begun.window.top - y / window.rowHeight });
  };
  const up = (event: PointerEvent) => {
    const begun = drag.current;
    drag.current = null;
    if (!begun || begun.moved || !canvas.current) return;
    const box = canvas.current.getBoundingClientRect();
    const row = rowAt(windowNow(), run.rows.length, event.clientY - box.top);
    choose(waitAt(row, event.clientX - box.left) ?? row);
  };
  /** The row that is waited for, where a wait of the selected row is clicked on. */
  const waitAt = (row: number, x: number): number | null => {
    if (row < 0 || row !== selected) return null;
    const window = windowNow();
    const own = run.rows[row];
    const start = own?.bars[0] ? xOf(window, size.current, own.bars[0].from) : Infinity;
    const wait = x > size.current.gutter && x < start ? own?.waits[0] : undefined;
    return wait && wait.row >= 0 ? wait.row : null;
  };

  const first = found ? [...found][0] : undefined;
  const counts = run.rows.filter((row) => row.status === 'running').length;
  return (
    <section className="gantt" aria-label="Gantt chart">
      <div className="bar">
        <label className="search">
          <span className="hidden">Find nodes</span>
          <input
            type="search" placeholder="Find nodes ( / )" data-search value={words}
            onChange={(event) => setWords(event.target.value)}
            onKeyDown={(event) => event.key === 'Enter' && first !== undefined && choose(first)}
          />
        </label>
        <span className="quiet">{found ? found.size + ' of ' : ''}{run.rows.length} nodes</span>
        <label><input type="checkbox" checked={onlyCritical} onChange={(event) => setOnlyCritical(event.target.checked)} /> critical path</label>
        <button type="button" className="small" aria-label="Zoom in" onClick={() => show(zoomed(windowNow(), 0.6, (windowNow().from + windowNow().until) / 2, nowOf(run)))}>+</button>
        <button type="button" className="small" aria-label="Zoom out" onClick={() => show(zoomed(windowNow(), 1 / 0.6, (windowNow().from + windowNow().until) / 2, nowOf(run)))}>−</button>
        <button type="button" className="small" onClick={() => show(null)}>whole run</button>
        <button type="button" className="small" onClick={fitRows}>all rows</button>
        {children}
      </div>
      <div
        ref={place} className="chart" tabIndex={0} role="application" onKeyDown={press}
        aria-label={'Gantt chart of ' + run.name + ': ' + run.rows.length + ' nodes, ' + counts + ' running. Up and down select a node, left and right move, plus and minus zoom.'}
      >
        <canvas ref={canvas} onPointerDown={down} onPointerMove={move} onPointerUp={up} aria-hidden="true" />
      </div>
    </section>
  );
}
