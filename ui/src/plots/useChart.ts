// SPDX-License-Identifier: Apache-2.0
import { useCallback, useEffect, useMemo, useRef, useState, type RefObject } from 'react';
import UPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { useLatest } from '../useLatest';
import type { Panel } from './layout';
import { ProfileRecorder, TimeRecorder } from './recorder';
import { useDark, useFrame, useSamples, useSize } from './useSamples';

const lightColours = ['#1f5fd0', '#b3400a', '#0b6b49', '#7a2fc0', '#a81f49', '#59616f', '#006d86', '#7c5c00'];
const darkColours = ['#82aefc', '#ff9d66', '#6fd3a8', '#c79bff', '#ff8fae', '#b8c0cc', '#5fd0e8', '#e6c04f'];

/** Of the line with that index. */
export const colourOf = (index: number, dark: boolean) => (dark ? darkColours : lightColours)[index % lightColours.length];

function shortNumber(value: number | null | undefined): string {
  if (value === null || value === undefined) return '–';
  return Number.isInteger(value) && Math.abs(value) < 1e6 ? String(value) : value.toPrecision(4);
}

type Range = [least: number, most: number];

/** A chart of uPlot in `holder`. */
function makeChart(holder: HTMLElement, profile: boolean, labels: string[], dark: boolean, range: () => Range | null, onZoom: (range: Range) => void, onCursor: () => void): UPlot {
  const text = getComputedStyle(holder).color;
  const axis = { stroke: text, grid: { stroke: 'rgba(127,127,127,.22)', width: 1 }, ticks: { show: false } };
  return new UPlot(
    {
      width: holder.clientWidth,
      height: holder.clientHeight,
      legend: { show: false },
      cursor: { drag: { x: true, y: false, setScale: false }, points: { size: 6 } },
      scales: { x: { time: false, range: (_chart, least, most) => range() ?? [least, Math.max(most, least + 1)] } },
      axes: [{ ...axis, size: 28, values: (_chart, ticks) => ticks.map((tick) => (profile ? String(tick) : Number(tick.toFixed(3)) + ' s')) }, { ...axis, size: 56 }],
      series: [{}, ...labels.map((label, index) => ({ label, stroke: colourOf(index, dark), width: 1.5, points: { show: false } }))],
      hooks: {
        setCursor: [onCursor],
        setSelect: [
          (chart) => {
            const { left, width } = chart.select;
            if (width < 4) return;
            onZoom([chart.posToVal(left, 'x'), chart.posToVal(left + width, 'x')]);
            chart.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          },
        ],
      },
    },
    [[], ...labels.map(() => [])] as UPlot.AlignedData,
    holder,
  );
}

/** Writes the values of lines into their places in the list: those at the cursor, or the newest. */
function writeValues(list: HTMLElement, chart: UPlot, profile: boolean): void {
  for (const place of list.querySelectorAll<HTMLElement>('[data-line]')) {
    const line = chart.data[Number(place.dataset['line']) + 1];
    let at = chart.cursor.idx ?? -1;
    // Ports have times of their own: the value before the cursor, or the newest.
    if (at < 0) at = (line?.length ?? 0) - 1;
    while (!profile && at > 0 && (line?.[at] ?? null) === null) --at;
    place.textContent = shortNumber(line?.[at]);
  }
}

/** The visible range times a factor, around the cursor or the middle; null: there is none. */
function zoomedRange(chart: UPlot | null, factor: number): Range | null {
  const scale = chart?.scales['x'];
  if (!chart || scale?.min === undefined || scale.max === undefined || scale.min === null || scale.max === null) return null;
  const at = chart.cursor.idx;
  const middle = typeof at === 'number' ? chart.data[0][at]! : (scale.min + scale.max) / 2;
  return [middle + (scale.min - middle) * factor, middle + (scale.max - middle) * factor];
}

function moveCursor(chart: UPlot | null, step: number): void {
  if (!chart) return;
  const last = chart.data[0].length - 1;
  const at = Math.min(last, Math.max(0, (chart.cursor.idx ?? last + (step < 0 ? 1 : 0)) + step));
  const x = chart.data[0][at];
  if (x !== undefined) chart.setCursor({ left: chart.valToPos(x, 'x'), top: 10 });
}

function useRecorder(panel: Panel, profile: boolean): TimeRecorder | ProfileRecorder {
  const sources = JSON.stringify(panel.sources);
  const recorder = useMemo(
    () => (profile ? new ProfileRecorder(panel.sources) : new TimeRecorder(panel.sources, panel.seconds)),
    [profile, sources], // eslint-disable-line: a new list of the same sources is not a change
  );
  if (recorder instanceof TimeRecorder) recorder.seconds = panel.seconds;
  return recorder;
}

/** The part of x that is zoomed to. Who zooms in time pauses the panel; `range` is what is seen. */
function useZoom(panel: Panel, profile: boolean, onPause: (paused: boolean) => void) {
  const [zoom, setZoom] = useState<Range | null>(null);
  const now = useLatest({ zoom, seconds: panel.seconds, onPause });
  const range = useCallback((): Range | null => now.current.zoom ?? (profile ? null : [-now.current.seconds, 0]), [now, profile]);
  const zoomTo = useCallback((chosen: Range) => {
    setZoom(chosen);
    if (!profile) now.current.onPause(true);
  }, [now, profile]);
  return { zoom, setZoom, range, zoomTo };
}

interface Made {
  holder: RefObject<HTMLDivElement | null>;
  labels: string[];
  profile: boolean;
  dark: boolean;
  range: () => Range | null;
  zoomTo: (range: Range) => void;
  /** Draws what has been recorded. */
  draw: () => void;
  showValues: () => void;
}

/** The chart in its holder, made anew where its lines or colours change. */
function useMade(chart: RefObject<UPlot | null>, { holder, labels, profile, dark, range, zoomTo, draw, showValues }: Made, hidden: Set<string>): void {
  useEffect(() => {
    const place = holder.current;
    if (!place || labels.length === 0) return;
    const made = makeChart(place, profile, labels, dark, range, zoomTo, showValues);
    chart.current = made;
    draw();
    return () => {
      made.destroy();
      chart.current = null;
    };
  }, [chart, holder, labels, dark, profile, range, zoomTo, draw, showValues]);
  useEffect(() => {
    labels.forEach((label, index) => chart.current?.setSeries(index + 1, { show: !hidden.has(label) }));
  }, [chart, labels, hidden, dark]);
}

/** A panel's samples as a chart in `holder`, and the values of its lines in `list`. */
export function useChart(panel: Panel, paused: boolean, onPause: (paused: boolean) => void) {
  const profile = panel.kind === 'profile';
  const holder = useRef<HTMLDivElement>(null);
  const list = useRef<HTMLUListElement>(null);
  const chart = useRef<UPlot | null>(null);
  const dark = useDark();
  const [labels, setLabels] = useState<string[]>([]);
  const [hidden, setHidden] = useState<Set<string>>(new Set());
  const { zoom, setZoom, range, zoomTo } = useZoom(panel, profile, onPause);
  const recorder = useRecorder(panel, profile);
  const showValues = useFrame(() => {
    if (chart.current && list.current) writeValues(list.current, chart.current, profile);
  });
  const draw = useFrame(() => {
    const drawn = recorder.drawn();
    setLabels((before) => (before.join('\n') === drawn.labels.join('\n') ? before : drawn.labels));
    if (chart.current?.series.length !== drawn.labels.length + 1) return;
    chart.current.setData(drawn.data);
    showValues();
  });
  const state = useSamples(panel.sources, paused, (document, time, sample) => {
    recorder.add(document, time, sample);
    draw();
  });
  useEffect(() => {
    if (paused) recorder.gap();
    else if (!profile) setZoom(null);
  }, [paused, recorder, profile, setZoom]);
  useMade(chart, { holder, labels, profile, dark, range, zoomTo, draw, showValues }, hidden);
  useEffect(draw, [draw, zoom, panel.seconds, recorder]);
  useSize(holder, useCallback(() => {
    const place = holder.current;
    if (place && chart.current && place.clientWidth > 0) chart.current.setSize({ width: place.clientWidth, height: place.clientHeight });
  }, []));
  const zoomBy = (factor: number) => {
    const zoomed = zoomedRange(chart.current, factor);
    if (zoomed) zoomTo(zoomed);
  };
  const toggle = (label: string) => setHidden(new Set(hidden.has(label) ? [...hidden].filter((one) => one !== label) : [...hidden, label]));
  return { holder, list, profile, dark, labels, hidden, toggle, zoom, zoomBy, showAll: () => setZoom(null), moveCursor: (step: number) => moveCursor(chart.current, step), state };
}
