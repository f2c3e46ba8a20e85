// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, type KeyboardEvent, type RefObject } from 'react';
import UPlot from 'uplot';
import { colourOf, makeChart, shortNumber, type Range } from '../plots/chart';
import type { Drawn } from '../plots/recorder';
import { useDark, useSize } from '../plots/useSamples';
import { useLatest } from '../useLatest';
import type { PhaseSpan } from './film';
import { valuesAt } from './film_samples';

const longestLegend = 16;
/** A pointer that has moved further, in pixels, was dragged. */
const still = 4;

interface Props {
  title: string;
  drawn: Drawn;
  phases: PhaseSpan[];
  /** The time of the film. */
  at: number;
  /** The times that are seen. */
  range: Range;
  onTime: (time: number) => void;
  onZoom: (range: Range) => void;
  onAll: () => void;
  onKey: (key: string) => boolean;
}

type Shown = Pick<Props, 'phases' | 'at' | 'range' | 'onTime' | 'onZoom'>;

/** Puts the line of the film's time, and the bands of phases, where the scale has them. */
function placeMarks(chart: UPlot, { phases, at }: Shown): void {
  const width = chart.over.clientWidth;
  const line = chart.over.querySelector<HTMLElement>('.film-cursor');
  const x = chart.valToPos(at, 'x');
  if (line) {
    line.hidden = !(x >= 0 && x <= width);
    line.style.left = x + 'px';
  }
  chart.under.querySelectorAll<HTMLElement>('.phase-band').forEach((band, index) => {
    const { from, to } = phases[index] ?? { from: 0, to: 0 };
    const left = chart.valToPos(from, 'x');
    band.style.left = left + 'px';
    band.style.width = Math.max(2, chart.valToPos(to, 'x') - left) + 'px';
  });
}

function addMarks(chart: UPlot, phases: PhaseSpan[]): void {
  const add = (place: HTMLElement, look: string) => {
    const mark = document.createElement('div');
    mark.className = look;
    place.append(mark);
  };
  for (const { phase } of phases) add(chart.under, 'phase-band phase-' + phase);
  add(chart.over, 'film-cursor');
}

/** A click moves the film; the end of a drag does not. */
function followClicks(chart: UPlot, onTime: (time: number) => void): void {
  let pressed = 0;
  chart.over.addEventListener('mousedown', (event) => {
    pressed = event.clientX;
  });
  chart.over.addEventListener('click', (event) => {
    if (Math.abs(event.clientX - pressed) < still) onTime(chart.posToVal(event.clientX - chart.over.getBoundingClientRect().left, 'x'));
  });
}

/** With some room around all values, so that a chart that is zoomed in time keeps its scale. */
function rangeOfValues({ data }: Drawn): Range {
  let [least, most] = [Infinity, -Infinity];
  for (const line of data.slice(1)) {
    for (const value of line) {
      if (typeof value !== 'number') continue;
      least = Math.min(least, value);
      most = Math.max(most, value);
    }
  }
  if (least > most) return [0, 1];
  const [low, high] = UPlot.rangeNum(least, most, 0.1, true);
  return [low ?? least, high ?? most];
}

function secondsText(seconds: number, [from, to]: Range): string {
  return to - from < 1 ? Number((seconds * 1e3).toFixed(2)) + ' ms' : Number(seconds.toFixed(3)) + ' s';
}

/** The chart in its holder, made anew where its lines or colours change. */
function useFilmChart(holder: RefObject<HTMLDivElement | null>, drawn: Drawn, shown: Shown): void {
  const chart = useRef<UPlot | null>(null);
  const dark = useDark();
  const now = useLatest({ ...shown, drawn });
  const names = drawn.labels.join('\n');
  useEffect(() => {
    const place = holder.current;
    if (!place) return undefined;
    const { drawn: first, phases } = now.current;
    const made = makeChart(place, {
      labels: first.labels,
      dark,
      range: () => now.current.range,
      yRange: () => rangeOfValues(now.current.drawn),
      xText: (x) => secondsText(x, now.current.range),
      onZoom: (range) => now.current.onZoom(range),
      onDrawn: (itself) => placeMarks(itself, now.current),
    });
    addMarks(made, phases);
    followClicks(made, (time) => now.current.onTime(time));
    made.setData(first.data);
    chart.current = made;
    return () => {
      made.destroy();
      chart.current = null;
    };
  }, [holder, names, dark, now]);
  const [from, to] = shown.range;
  useEffect(() => chart.current?.setData(drawn.data), [drawn, from, to]);
  useEffect(() => {
    if (chart.current) placeMarks(chart.current, now.current);
  }, [now, shown.at]);
  const fit = useRef(() => {
    const place = holder.current;
    if (place && chart.current && place.clientWidth > 0) chart.current.setSize({ width: place.clientWidth, height: place.clientHeight });
  });
  useSize(holder, fit.current);
}

/** The samples of a panel over the time of a film, with a line at the film's moment, and the values of then. */
export function FilmChart({ title, drawn, onAll, onKey, ...shown }: Props) {
  const holder = useRef<HTMLDivElement>(null);
  const dark = useDark();
  useFilmChart(holder, drawn, shown);
  const values = valuesAt(drawn, shown.at);
  const press = (event: KeyboardEvent) => {
    if (onKey(event.key)) event.preventDefault();
  };
  return (
    <section className="film-chart" aria-label={title}>
      <h3 title={title}>{title}</h3>
      <div
        ref={holder} className="chart" role="img" tabIndex={0} onDoubleClick={onAll} onKeyDown={press}
        aria-label={'Chart of ' + title + ' during the transition; a click and the arrow keys move the film, plus and minus zoom'}
      />
      <ul className="plain lines" aria-label={'Values of ' + title}>
        {drawn.labels.slice(0, longestLegend).map((label, index) => (
          <li key={label}><i style={{ background: colourOf(index, dark) }} /> {label} <b>{shortNumber(values[index])}</b></li>
        ))}
        {drawn.labels.length > longestLegend && <li className="quiet">and {drawn.labels.length - longestLegend} more</li>}
      </ul>
    </section>
  );
}
