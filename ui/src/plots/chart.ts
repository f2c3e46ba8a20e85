// SPDX-License-Identifier: Apache-2.0
import UPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';

const lightColours = ['#1f5fd0', '#b3400a', '#0b6b49', '#7a2fc0', '#a81f49', '#59616f', '#006d86', '#7c5c00'];
const darkColours = ['#82aefc', '#ff9d66', '#6fd3a8', '#c79bff', '#ff8fae', '#b8c0cc', '#5fd0e8', '#e6c04f'];

/** Of the line with that index. */
export const colourOf = (index: number, dark: boolean) => (dark ? darkColours : lightColours)[index % lightColours.length];

export function shortNumber(value: number | null | undefined): string {
  if (value === null || value === undefined) return '–';
  return Number.isInteger(value) && Math.abs(value) < 1e6 ? String(value) : value.toPrecision(4);
}

export type Range = [least: number, most: number];

interface Options {
  labels: string[];
  dark: boolean;
  /** Of x; null: all of it. */
  range: () => Range | null;
  /** Of y; without it, that of the values that are seen. */
  yRange?: () => Range;
  xText: (x: number) => string;
  /** A range was chosen by dragging. */
  onZoom: (range: Range) => void;
  onCursor?: () => void;
  /** The chart was drawn, maybe with other scales or in another size. */
  onDrawn?: (chart: UPlot) => void;
}

/** A chart of uPlot in `holder`, without data. */
export function makeChart(holder: HTMLElement, { labels, dark, range, yRange, xText, onZoom, onCursor, onDrawn }: Options): UPlot {
  const text = getComputedStyle(holder).color;
  const axis = { stroke: text, grid: { stroke: 'rgba(127,127,127,.22)', width: 1 }, ticks: { show: false } };
  return new UPlot(
    {
      width: holder.clientWidth,
      height: holder.clientHeight,
      legend: { show: false },
      cursor: { drag: { x: true, y: false, setScale: false }, points: { size: 6 } },
      scales: { x: { time: false, range: (_chart, least, most) => range() ?? [least, Math.max(most, least + 1)] }, y: yRange ? { range: yRange } : {} },
      axes: [{ ...axis, size: 28, values: (_chart, ticks) => ticks.map(xText) }, { ...axis, size: 56 }],
      series: [{}, ...labels.map((label, index) => ({ label, stroke: colourOf(index, dark), width: 1.5, points: { show: false } }))],
      hooks: {
        setCursor: onCursor ? [onCursor] : [],
        draw: onDrawn ? [onDrawn] : [],
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
export function writeValues(list: HTMLElement, chart: UPlot, profile: boolean): void {
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
export function zoomedRange(chart: UPlot | null, factor: number): Range | null {
  const scale = chart?.scales['x'];
  if (!chart || scale?.min === undefined || scale.max === undefined || scale.min === null || scale.max === null) return null;
  const at = chart.cursor.idx;
  const middle = typeof at === 'number' ? chart.data[0][at]! : (scale.min + scale.max) / 2;
  return [middle + (scale.min - middle) * factor, middle + (scale.max - middle) * factor];
}
