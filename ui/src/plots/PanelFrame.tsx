// SPDX-License-Identifier: Apache-2.0
import { useState } from 'react';
import { ChartPanel } from './ChartPanel';
import { ImagePanel } from './ImagePanel';
import { windows, type Panel } from './layout';
import { MapPanel } from './MapPanel';

const sizes = [1, 2, 3].flatMap((rows) => [1, 2, 3].map((columns) => columns + ' × ' + rows));

function secondsText(seconds: number): string {
  return seconds < 60 ? seconds + ' s' : seconds / 60 + ' min';
}

/** A panel with what all kinds of panels have: title, place, size, pause. */
export function PanelFrame({ panel, onChange, onEdit, onMove, onRemove, onDrop }: {
  panel: Panel;
  onChange: (panel: Panel) => void;
  onEdit: () => void;
  /** -1: earlier, 1: later. */
  onMove: (step: number) => void;
  onRemove: () => void;
  /** The panel with this id was dropped here. */
  onDrop: (id: number) => void;
}) {
  const [paused, setPaused] = useState(false);
  const shown = { panel, paused };
  const chosenWindows = windows.includes(panel.seconds) ? windows : [panel.seconds, ...windows];
  return (
    <section
      className="plot-panel"
      aria-label={panel.title}
      style={{ gridColumn: 'span ' + panel.columns, gridRow: 'span ' + panel.rows }}
      onDragOver={(event) => event.dataTransfer.types.includes('text/x-segue-panel') && event.preventDefault()}
      onDrop={(event) => {
        event.preventDefault();
        onDrop(Number(event.dataTransfer.getData('text/x-segue-panel')));
      }}
    >
      <header draggable onDragStart={(event) => event.dataTransfer.setData('text/x-segue-panel', String(panel.id))}>
        <h2 title={panel.title}>{panel.title}</h2>
        {(panel.kind === 'time' || panel.kind === 'map') && (
          <select aria-label={'Time shown in ' + panel.title} value={panel.seconds} onChange={(event) => onChange({ ...panel, seconds: Number(event.target.value) })}>
            {chosenWindows.map((seconds) => <option key={seconds} value={seconds}>{secondsText(seconds)}</option>)}
          </select>
        )}
        <select
          aria-label={'Size of ' + panel.title}
          value={panel.columns + ' × ' + panel.rows}
          onChange={(event) => {
            const [columns, rows] = event.target.value.split(' × ').map(Number);
            onChange({ ...panel, columns: columns ?? 1, rows: rows ?? 1 });
          }}
        >
          {sizes.map((size) => <option key={size}>{size}</option>)}
        </select>
        <button type="button" className="small" aria-pressed={paused} aria-label={(paused ? 'Go on with ' : 'Pause ') + panel.title} onClick={() => setPaused(!paused)}>
          {paused ? 'Go on' : 'Pause'}
        </button>
        <button type="button" className="small" aria-label={'Fields of ' + panel.title} onClick={onEdit}>Fields</button>
        <button type="button" className="small" aria-label={'Move ' + panel.title + ' earlier'} onClick={() => onMove(-1)}>◂</button>
        <button type="button" className="small" aria-label={'Move ' + panel.title + ' later'} onClick={() => onMove(1)}>▸</button>
        <button type="button" className="small" aria-label={'Remove ' + panel.title} onClick={onRemove}>×</button>
      </header>
      {panel.kind === 'image' && <ImagePanel {...shown} />}
      {panel.kind === 'map' && <MapPanel {...shown} />}
      {(panel.kind === 'time' || panel.kind === 'profile') && (
        <ChartPanel key={panel.kind + JSON.stringify(panel.sources)} {...shown} onPause={setPaused} />
      )}
    </section>
  );
}
