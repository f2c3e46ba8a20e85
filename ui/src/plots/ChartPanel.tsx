// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useRef, useState } from 'react';
import UPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { Footer } from './Footer';
import type { Panel } from './layout';
import { ProfileRecorder, TimeRecorder } from './recorder';
import { useDark, useFrame, useSamples, useSize } from './useSamples';

const lightColours = ['#1f5fd0', '#b3400a', '#0b6b49', '#7a2fc0', '#a81f49', '#59616f', '#006d86', '#7c5c00'];
const darkColours = ['#82aefc', '#ff9d66', '#6fd3a8', '#c79bff', '#ff8fae', '#b8c0cc', '#5fd0e8', '#e6c04f'];
const longestLegend = 16;

function shortNumber(value: number | null | undefined): string {
  if (value === null || value === undefined) return '–';
  return Number.isInteger(value) && Math.abs(value) < 1e6 ? String(value) : value.toPrecision(4);
}

type Range = [least: number, most: number];

/** A chart of uPlot in `holder`. */
function makeChart(holder: HTMLElement, profile: boolean, labels: string[], dark: boolean, range: () => Range | null, onZoom: (range: Range) => void, onCursor: () => void): UPlot {
  const colours = dark ? darkColours : lightColours;
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
      series: [{}, ...labels.map((label, index) => ({ label, stroke: colours[index % colours.length], width: 1.5, points: { show: false } }))],
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

/** Lines over time, or the newest lists over their indices. */
export function ChartPanel({ panel, paused, onPause }: { panel: Panel; paused: boolean; onPause: (paused: boolean) => void }) {
  const profile = panel.kind === 'profile';
  const holder = useRef<HTMLDivElement>(null);
  const values = useRef<HTMLUListElement>(null);
  const chart = useRef<UPlot | null>(null);
  const dark = useDark();
  const [labels, setLabels] = useState<string[]>([]);
  const [hidden, setHidden] = useState<Set<string>>(new Set());
  const [zoom, setZoom] = useState<Range | null>(null);
  const zoomNow = useRef<Range | null>(zoom);
  zoomNow.current = zoom;
  const secondsNow = useRef(panel.seconds);
  secondsNow.current = panel.seconds;
  const sources = JSON.stringify(panel.sources);
  const recorder = useMemo(
    () => (profile ? new ProfileRecorder(panel.sources) : new TimeRecorder(panel.sources, panel.seconds)),
    [profile, sources], // eslint-disable-line: a new list of the same sources is not a change
  );
  if (recorder instanceof TimeRecorder) recorder.seconds = panel.seconds;

  const showValues = useFrame(() => {
    const drawn = chart.current;
    if (!drawn || !values.current) return;
    for (const place of values.current.querySelectorAll<HTMLElement>('[data-line]')) {
      const line = drawn.data[Number(place.dataset['line']) + 1];
      let at = drawn.cursor.idx ?? -1;
      // Ports have times of their own: the value before the cursor, or the newest.
      if (at < 0) at = (line?.length ?? 0) - 1;
      while (!profile && at > 0 && (line?.[at] ?? null) === null) --at;
      place.textContent = shortNumber(line?.[at]);
    }
  });
  const draw = useFrame(() => {
    const drawn = recorder.drawn();
    setLabels((before) => (before.join('\n') === drawn.labels.join('\n') ? before : drawn.labels));
    if (chart.current && chart.current.series.length === drawn.labels.length + 1) {
      chart.current.setData(drawn.data);
      showValues();
    }
  });
  const state = useSamples(panel.sources, paused, (document, time, sample) => {
    recorder.add(document, time, sample);
    draw();
  });

  useEffect(() => {
    if (paused) recorder.gap();
    else if (!profile) setZoom(null);
  }, [paused, recorder, profile]);

  useEffect(() => {
    const place = holder.current;
    if (!place || labels.length === 0) return;
    const range = (): Range | null => zoomNow.current ?? (profile ? null : [-secondsNow.current, 0]);
    const made = makeChart(place, profile, labels, dark, range, (chosen) => {
      setZoom(chosen);
      if (!profile) onPause(true);
    }, showValues);
    chart.current = made;
    draw();
    return () => {
      made.destroy();
      chart.current = null;
    };
    // onPause may be another function each time; it does the same.
  }, [labels, dark, profile, draw, showValues]);

  useEffect(() => {
    labels.forEach((label, index) => chart.current?.setSeries(index + 1, { show: !hidden.has(label) }));
  }, [labels, hidden, dark]);
  useEffect(draw, [draw, zoom, panel.seconds, recorder]);
  useSize(holder, useRef(() => {
    const place = holder.current;
    if (place && chart.current && place.clientWidth > 0) chart.current.setSize({ width: place.clientWidth, height: place.clientHeight });
  }).current);

  const zoomBy = (factor: number) => {
    const scale = chart.current?.scales['x'];
    if (scale?.min === undefined || scale.max === undefined || scale.min === null || scale.max === null) return;
    const at = chart.current?.cursor.idx;
    const middle = typeof at === 'number' ? chart.current!.data[0][at]! : (scale.min + scale.max) / 2;
    setZoom([middle + (scale.min - middle) * factor, middle + (scale.max - middle) * factor]);
    if (!profile) onPause(true);
  };
  const moveCursor = (step: number) => {
    const drawn = chart.current;
    if (!drawn) return;
    const last = drawn.data[0].length - 1;
    const at = Math.min(last, Math.max(0, (drawn.cursor.idx ?? last + (step < 0 ? 1 : 0)) + step));
    const x = drawn.data[0][at];
    if (x !== undefined) drawn.setCursor({ left: drawn.valToPos(x, 'x'), top: 10 });
  };

  return (
    <>
      <div className="panel-tools">
        <button type="button" className="small" aria-label="Zoom in" onClick={() => zoomBy(0.5)}>+</button>
        <button type="button" className="small" aria-label="Zoom out" onClick={() => zoomBy(2)}>−</button>
        <button type="button" className="small" disabled={!zoom} onClick={() => setZoom(null)}>All</button>
      </div>
      <div
        ref={holder}
        className="chart"
        role="img"
        tabIndex={0}
        aria-label={'Chart of ' + panel.title + '; arrow keys move the cursor, plus and minus zoom'}
        onDoubleClick={() => setZoom(null)}
        onKeyDown={(event) => {
          if (event.key === 'ArrowLeft') moveCursor(-1);
          else if (event.key === 'ArrowRight') moveCursor(1);
          else if (event.key === '+') zoomBy(0.5);
          else if (event.key === '-') zoomBy(2);
          else return;
          event.preventDefault();
        }}
      />
      <ul className="plain lines" ref={values} aria-label={'Lines of ' + panel.title}>
        {labels.slice(0, longestLegend).map((label, index) => (
          <li key={label}>
            <button
              type="button"
              aria-pressed={!hidden.has(label)}
              title={hidden.has(label) ? 'Show' : 'Hide'}
              onClick={() => setHidden(new Set(hidden.has(label) ? [...hidden].filter((one) => one !== label) : [...hidden, label]))}
            >
              <i style={{ background: (dark ? darkColours : lightColours)[index % lightColours.length] }} /> {label}{' '}
              {!profile && <b data-line={index}>–</b>}
              {profile && <b data-line={index} />}
            </button>
          </li>
        ))}
        {labels.length > longestLegend && <li className="quiet">and {labels.length - longestLegend} more</li>}
      </ul>
      <Footer state={state} paused={paused} />
    </>
  );
}
