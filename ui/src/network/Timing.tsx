// SPDX-License-Identifier: Apache-2.0
import type { Histogram, TaskReport } from '../robot/types';
import { microsecondsText } from '../units';
import { barsOf, summaryOf } from './histogram';

const width = 330;
const height = 64;

/** Counts by duration; both axes are logarithmic. The table has the same numbers for people who cannot see the drawing. */
function HistogramFigure({ title, histogram }: { title: string; histogram: Histogram }) {
  const bars = barsOf(histogram);
  const step = Math.min(24, width / Math.max(1, bars.length));
  return (
    <figure className="histogram">
      <figcaption>{title}: {summaryOf(histogram)}</figcaption>
      {bars.length > 0 && (
        <>
          <svg viewBox={`0 0 ${width} ${height}`} role="img" aria-label={title + ': ' + summaryOf(histogram)}>
            {bars.map((bar, index) => (
              <rect key={bar.from} x={index * step} y={height * (1 - bar.height)} width={Math.max(1, step - 1)} height={height * bar.height}>
                <title>{`${bar.from} to ${bar.below || 'more'}: ${bar.count}`}</title>
              </rect>
            ))}
          </svg>
          <div className="axis" style={{ width: `${(100 * step * bars.length) / width}%` }}>
            <span>{bars[0]?.from}</span>
            <span>{bars[bars.length - 1]?.below}</span>
          </div>
          <details>
            <summary>as a table</summary>
            <table>
              <thead>
                <tr><th scope="col">From</th><th scope="col">Below</th><th scope="col">Count</th></tr>
              </thead>
              <tbody>
                {bars.map((bar) => (
                  <tr key={bar.from}><td>{bar.from}</td><td>{bar.below}</td><td className="number">{bar.count}</td></tr>
                ))}
              </tbody>
            </table>
          </details>
        </>
      )}
    </figure>
  );
}

export function Timing({ report }: { report: TaskReport }) {
  return (
    <section aria-label="Timing">
      <h3>Timing</h3>
      <dl className="numbers">
        {Object.entries(report.timing).map(([name, number]) => (
          <div key={name}>
            <dt>{name.replace(/_us$/, '').replace(/_/g, ' ')}</dt>
            <dd>{name.endsWith('_us') ? microsecondsText(number) : number}</dd>
          </div>
        ))}
      </dl>
      {report.histograms && (
        <>
          <HistogramFigure title="Updates" histogram={report.histograms.updates} />
          <HistogramFigure title="Latencies" histogram={report.histograms.latencies} />
        </>
      )}
    </section>
  );
}
