// SPDX-License-Identifier: Apache-2.0
import { useCallback, useEffect, useRef, useState, type RefObject } from 'react';
import type UPlot from 'uplot';
import { useLatest } from '../useLatest';
import { makeChart, writeValues, zoomedRange, type Range } from './chart';
import type { Panel } from './layout';
import { ProfileRecorder } from './recorder';
import { useKept } from './usePlots';
import { useDark, useFrame, useSamples, useSize } from './useSamples';

function moveCursor(chart: UPlot | null, step: number): void {
  if (!chart) return;
  const last = chart.data[0].length - 1;
  const at = Math.min(last, Math.max(0, (chart.cursor.idx ?? last + (step < 0 ? 1 : 0)) + step));
  const x = chart.data[0][at];
  if (x !== undefined) chart.setCursor({ left: chart.valToPos(x, 'x'), top: 10 });
}

/** The samples of a panel: of its lists those that come from now on, over time those that the page keeps. */
function useRecorded(panel: Panel, paused: boolean, draw: () => void) {
  const profile = panel.kind === 'profile';
  const [lists] = useState(() => new ProfileRecorder(panel.sources));
  const kept = useKept(profile ? null : panel, paused, draw);
  const state = useSamples(profile ? panel.sources : [], paused, (document, time, sample) => {
    lists.add(document, time, sample);
    draw();
  });
  return { drawn: () => (kept ? kept.recorder.drawn(panel.seconds) : lists.drawn()), state: kept?.state ?? state };
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
    const xText = profile ? String : (seconds: number) => Number(seconds.toFixed(3)) + ' s';
    const made = makeChart(place, { labels, dark, range, xText, onZoom: zoomTo, onCursor: showValues });
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
  const showValues = useFrame(() => {
    if (chart.current && list.current) writeValues(list.current, chart.current, profile);
  });
  const draw = useFrame(() => {
    const drawn = recorded.drawn();
    setLabels((before) => (before.join('\n') === drawn.labels.join('\n') ? before : drawn.labels));
    if (chart.current?.series.length !== drawn.labels.length + 1) return;
    chart.current.setData(drawn.data);
    showValues();
  });
  const recorded = useRecorded(panel, paused, draw);
  useEffect(() => {
    if (!paused && !profile) setZoom(null);
  }, [paused, profile, setZoom]);
  useMade(chart, { holder, labels, profile, dark, range, zoomTo, draw, showValues }, hidden);
  useEffect(draw, [draw, zoom, panel.seconds]);
  useSize(holder, useCallback(() => {
    const place = holder.current;
    if (place && chart.current && place.clientWidth > 0) chart.current.setSize({ width: place.clientWidth, height: place.clientHeight });
  }, []));
  const zoomBy = (factor: number) => {
    const zoomed = zoomedRange(chart.current, factor);
    if (zoomed) zoomTo(zoomed);
  };
  const toggle = (label: string) => setHidden(new Set(hidden.has(label) ? [...hidden].filter((one) => one !== label) : [...hidden, label]));
  return { holder, list, profile, dark, labels, hidden, toggle, zoom, zoomBy, showAll: () => setZoom(null), moveCursor: (step: number) => moveCursor(chart.current, step), state: recorded.state };
}
