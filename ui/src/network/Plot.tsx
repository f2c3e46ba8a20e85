// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef } from 'react';
import UPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import type { Json } from '../robot/change';
import { Series } from './series';

const colours = ['#2f6fde', '#c2410c', '#0f8a5f', '#8b3fd1', '#b0254f', '#71717a'];
const shownSeconds = 30;

/** The numbers of a port's samples over the last half minute. */
export function Plot({ time, value, frozen, label }: { time: number; value: Json; frozen: boolean; label: string }) {
  const place = useRef<HTMLDivElement>(null);
  const series = useRef(new Series(shownSeconds));
  const plot = useRef<UPlot | null>(null);

  useEffect(() => () => plot.current?.destroy(), []);

  useEffect(() => {
    const holder = place.current;
    if (!holder || !series.current.add(time, value) || frozen) return; // what comes meanwhile is there afterwards
    const { times, columns } = series.current;
    const data = [times.map((at) => at - time), ...columns.values()] as UPlot.AlignedData;
    if (plot.current && plot.current.series.length !== columns.size + 1) {
      plot.current.destroy();
      plot.current = null;
    }
    const text = getComputedStyle(holder).color;
    plot.current ??= new UPlot(
      {
        width: holder.clientWidth,
        height: 150,
        legend: { live: false },
        cursor: { show: false },
        scales: { x: { time: false, range: [-shownSeconds, 0] } },
        axes: [
          { stroke: text, grid: { stroke: 'rgba(127,127,127,.2)' }, ticks: { show: false }, values: (_, ticks) => ticks.map((tick) => tick + ' s') },
          { stroke: text, grid: { stroke: 'rgba(127,127,127,.2)' }, ticks: { show: false }, size: 52 },
        ],
        series: [{}, ...[...columns.keys()].map((path, index) => ({ label: path, stroke: colours[index % colours.length], width: 1.5 }))],
      },
      data,
      holder,
    );
    plot.current.setData(data);
  }, [time, value, frozen]);

  return <div ref={place} className="plot" role="img" aria-label={'Plot of ' + label} />;
}
