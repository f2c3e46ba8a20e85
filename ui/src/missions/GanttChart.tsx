// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useRef, useState, type KeyboardEvent, type PointerEvent, type ReactNode } from 'react';
import type { Window } from '../../../segue/draw/gantt_chart.js';
import { ChartView, type Drawn } from './chart_view';
import { Bars } from './gantt';
import type { Run } from './run';

const refreshPause = 100;

/** The view of a run, drawn again wherever the run or its marks change, and again and again while the run goes on. */
function useView(drawn: Drawn) {
  const { run, bars, marks } = drawn;
  const place = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const [view] = useState(() => new ChartView(drawn));
  view.drawn = drawn;
  useEffect(() => (place.current && canvas.current ? view.mount(place.current, canvas.current) : undefined), [view]);
  useEffect(() => view.draw(), [view, bars, marks.selected, marks.found, marks.onlyCritical]);
  useEffect(() => {
    if (run.ended) return;
    const timer = setInterval(() => view.draw(), refreshPause);
    return () => clearInterval(timer);
  }, [view, run.ended]);
  useEffect(() => view.show(null), [view, run.name, run.began]);
  return { place, canvas, view };
}

/** Drags the chart; a click chooses a row. */
function useDrag(view: ChartView, choose: (row: number) => void) {
  const drag = useRef<{ x: number; y: number; window: Window; moved: boolean } | null>(null);
  const onPointerDown = (event: PointerEvent) => {
    drag.current = { x: event.clientX, y: event.clientY, window: view.window, moved: false };
    event.currentTarget.setPointerCapture(event.pointerId);
  };
  const onPointerMove = (event: PointerEvent) => {
    const begun = drag.current;
    if (!begun) return;
    const x = event.clientX - begun.x;
    const y = event.clientY - begun.y;
    if (!begun.moved && Math.abs(x) + Math.abs(y) < 4) return;
    begun.moved = true;
    view.drag(begun.window, x, y);
  };
  const onPointerUp = (event: PointerEvent) => {
    const begun = drag.current;
    drag.current = null;
    if (begun && !begun.moved) choose(view.rowAt(event.clientX, event.clientY));
  };
  return { onPointerDown, onPointerMove, onPointerUp };
}

/** The action of a key, or null. */
function actionOf(key: string, view: ChartView, choose: (row: number) => void): (() => void) | null {
  const { run, marks } = view.drawn;
  const actions: Record<string, () => void> = {
    ArrowLeft: () => view.move(-0.1),
    ArrowRight: () => view.move(0.1),
    ArrowUp: () => choose(Math.max(0, marks.selected - 1)),
    ArrowDown: () => choose(Math.min(run.rows.length - 1, marks.selected + 1)),
    PageUp: () => view.scrollPages(-1),
    PageDown: () => view.scrollPages(1),
    Home: () => view.show(null),
    '+': () => view.zoom(0.7),
    '-': () => view.zoom(1 / 0.7),
    Escape: () => choose(-1),
  };
  return actions[key] ?? null;
}

interface FinderProps {
  words: string;
  onWords: (words: string) => void;
  onEnter: () => void;
}

function Finder({ words, onWords, onEnter }: FinderProps) {
  return (
    <label className="search">
      <span className="hidden">Find nodes</span>
      <input
        type="search" placeholder="Find nodes ( / )" data-search value={words}
        onChange={(event) => onWords(event.target.value)} onKeyDown={(event) => event.key === 'Enter' && onEnter()}
      />
    </label>
  );
}

/** The rows with these words; null: there are no words. */
function useFound(run: Run, words: string): Set<number> | null {
  return useMemo(() => {
    const wanted = words.trim().toLowerCase();
    if (wanted === '') return null;
    return new Set(run.rows.flatMap((row, index) => ((row.label + ' ' + row.status).toLowerCase().includes(wanted) ? [index] : [])));
  }, [run, words]);
}

interface Props {
  run: Run;
  selected: number;
  onSelect: (row: number) => void;
  children?: ReactNode;
}

/** A run on a canvas. */
export function GanttChart({ run, selected, onSelect, children }: Props) {
  const [words, setWords] = useState('');
  const [onlyCritical, setOnlyCritical] = useState(false);
  const bars = useMemo(() => new Bars(run.rows), [run]);
  const found = useFound(run, words);
  const { place, canvas, view } = useView({ run, bars, marks: { selected, found, onlyCritical } });
  const choose = (row: number) => [onSelect(row), view.reveal(row)];
  const drag = useDrag(view, choose);
  const press = (event: KeyboardEvent) => {
    const action = actionOf(event.key, view, choose);
    if (!action || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    action();
  };
  const first = found ? [...found][0] : undefined;
  const running = run.rows.filter((row) => row.status === 'running').length;
  return (
    <section className="gantt" aria-label="Gantt chart">
      <div className="bar">
        <Finder words={words} onWords={setWords} onEnter={() => first !== undefined && choose(first)} />
        <span className="quiet">{found ? found.size + ' of ' : ''}{run.rows.length} nodes</span>
        <label><input type="checkbox" checked={onlyCritical} onChange={(event) => setOnlyCritical(event.target.checked)} /> critical path</label>
        <button type="button" className="small" aria-label="Zoom in" onClick={() => view.zoom(0.6)}>+</button>
        <button type="button" className="small" aria-label="Zoom out" onClick={() => view.zoom(1 / 0.6)}>−</button>
        <button type="button" className="small" onClick={() => view.show(null)}>whole run</button>
        <button type="button" className="small" onClick={() => view.fitRows()}>all rows</button>
        {children}
      </div>
      <div
        ref={place} className="chart" tabIndex={0} role="application" onKeyDown={press}
        aria-label={'Gantt chart of ' + run.name + ': ' + run.rows.length + ' nodes, ' + running + ' running. Up and down select a node, left and right move, plus and minus zoom.'}
      >
        <canvas ref={canvas} {...drag} aria-hidden="true" />
      </div>
    </section>
  );
}
