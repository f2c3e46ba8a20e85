// SPDX-License-Identifier: Apache-2.0
import type { KeyboardEvent } from 'react';
import { ActionButton } from '../ActionButton';
import { colourOf } from './chart';
import { Footer } from './Footer';
import type { Panel } from './layout';
import { useChart } from './useChart';

const longestLegend = 16;

type Chart = ReturnType<typeof useChart>;

/** The lines with their values; a click hides or shows one. */
function Lines({ title, chart: { list, profile, dark, labels, hidden, toggle } }: { title: string; chart: Chart }) {
  return (
    <ul className="plain lines" ref={list} aria-label={'Lines of ' + title}>
      {labels.slice(0, longestLegend).map((label, index) => (
        <li key={label}>
          <button type="button" aria-pressed={!hidden.has(label)} title={hidden.has(label) ? 'Show' : 'Hide'} onClick={() => toggle(label)}>
            <i style={{ background: colourOf(index, dark) }} /> {label}{' '}
            {!profile && <b data-line={index}>–</b>}
            {profile && <b data-line={index} />}
          </button>
        </li>
      ))}
      {labels.length > longestLegend && <li className="quiet">and {labels.length - longestLegend} more</li>}
    </ul>
  );
}

/** Lines over time, or the newest lists over their indices. */
export function ChartPanel({ panel, paused, onPause }: { panel: Panel; paused: boolean; onPause: (paused: boolean) => void }) {
  const chart = useChart(panel, paused, onPause);
  const { holder, zoom, zoomBy, showAll, moveCursor, state } = chart;
  const press = (event: KeyboardEvent) => {
    if (event.key === 'ArrowLeft') moveCursor(-1);
    else if (event.key === 'ArrowRight') moveCursor(1);
    else if (event.key === '+') zoomBy(0.5);
    else if (event.key === '-') zoomBy(2);
    else return;
    event.preventDefault();
  };
  return (
    <>
      <div className="panel-tools">
        <button type="button" className="small" aria-label="Zoom in" onClick={() => zoomBy(0.5)}>+</button>
        <button type="button" className="small" aria-label="Zoom out" onClick={() => zoomBy(2)}>−</button>
        <ActionButton type="button" className="small" tip whyNot={zoom ? '' : 'all is shown'} onClick={showAll}>All</ActionButton>
      </div>
      <div
        ref={holder}
        className="chart"
        role="img"
        tabIndex={0}
        aria-label={'Chart of ' + panel.title + '; arrow keys move the cursor, plus and minus zoom'}
        onDoubleClick={showAll}
        onKeyDown={press}
      />
      <Lines title={panel.title} chart={chart} />
      <Footer state={state} paused={paused} />
    </>
  );
}
