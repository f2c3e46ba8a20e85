// SPDX-License-Identifier: Apache-2.0
import { lazy, Suspense, useState } from 'react';
import { ChartPanel } from './ChartPanel';
import { ImagePanel } from './ImagePanel';
import { windows, type Panel } from './layout';
import { MapPanel } from './MapPanel';

const SpacePanel = lazy(() => import('./SpacePanel').then((part) => ({ default: part.SpacePanel }))); // its library is large

const sizes = [1, 2, 3].flatMap((rows) => [1, 2, 3].map((columns) => columns + ' × ' + rows));

function secondsText(seconds: number): string {
  return seconds < 60 ? seconds + ' s' : seconds / 60 + ' min';
}

interface Props {
  panel: Panel;
  onChange: (panel: Panel) => void;
  onEdit: () => void;
  /** -1: earlier, 1: later. */
  onMove: (step: number) => void;
  onRemove: () => void;
  /** The panel with this id was dropped here. */
  onDrop: (id: number) => void;
}

/** How much of the past is shown, in kinds that show it. */
function TimeChoice({ panel, onChange }: Pick<Props, 'panel' | 'onChange'>) {
  if (panel.kind !== 'time' && panel.kind !== 'map' && panel.kind !== 'space') return null;
  const chosenWindows = windows.includes(panel.seconds) ? windows : [panel.seconds, ...windows];
  return (
    <select aria-label={'Time shown in ' + panel.title} value={panel.seconds} onChange={(event) => onChange({ ...panel, seconds: Number(event.target.value) })}>
      {chosenWindows.map((seconds) => <option key={seconds} value={seconds}>{secondsText(seconds)}</option>)}
    </select>
  );
}

function SizeChoice({ panel, onChange }: Pick<Props, 'panel' | 'onChange'>) {
  return (
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
  );
}

function Header({ panel, onChange, onEdit, onMove, onRemove, paused, onPause }: Omit<Props, 'onDrop'> & { paused: boolean; onPause: (paused: boolean) => void }) {
  return (
    <header draggable onDragStart={(event) => event.dataTransfer.setData('text/x-segue-panel', String(panel.id))}>
      <h2 title={panel.title}>{panel.title}</h2>
      <TimeChoice panel={panel} onChange={onChange} />
      <SizeChoice panel={panel} onChange={onChange} />
      <button type="button" className="small" aria-pressed={paused} aria-label={(paused ? 'Go on with ' : 'Pause ') + panel.title} onClick={() => onPause(!paused)}>
        {paused ? 'Go on' : 'Pause'}
      </button>
      <button type="button" className="small" aria-label={'Fields of ' + panel.title} onClick={onEdit}>Fields</button>
      <button type="button" className="small" aria-label={'Move ' + panel.title + ' earlier'} onClick={() => onMove(-1)}>◂</button>
      <button type="button" className="small" aria-label={'Move ' + panel.title + ' later'} onClick={() => onMove(1)}>▸</button>
      <button type="button" className="small" aria-label={'Remove ' + panel.title} onClick={onRemove}>×</button>
    </header>
  );
}

/** A panel with what all kinds of panels have: title, place, size, pause. */
export function PanelFrame({ onDrop, ...props }: Props) {
  const { panel } = props;
  const [paused, setPaused] = useState(false);
  const shown = { panel, paused };
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
      <Header {...props} paused={paused} onPause={setPaused} />
      {panel.kind === 'image' && <ImagePanel {...shown} />}
      {panel.kind === 'map' && <MapPanel {...shown} />}
      {panel.kind === 'space' && <Suspense fallback={<p className="empty">…</p>}><SpacePanel {...shown} /></Suspense>}
      {(panel.kind === 'time' || panel.kind === 'profile') && (
        <ChartPanel key={panel.kind + JSON.stringify(panel.sources)} {...shown} onPause={setPaused} />
      )}
    </section>
  );
}
