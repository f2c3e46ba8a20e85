// SPDX-License-Identifier: Apache-2.0
import { useRef, useState } from 'react';
import { ActionButton } from '../ActionButton';
import { useConnection } from '../robot/hooks';
import type { Status } from '../robot/types';
import { layoutText, mostPanels, newId, type Panel } from './layout';
import { PanelDialog, type Chosen } from './PanelDialog';
import { PanelFrame } from './PanelFrame';
import { download } from './stored';
import { usePlots, type Plots } from './usePlots';
import './plots.css';

function LoadButton({ onFile }: { onFile: (file: File) => void }) {
  const input = useRef<HTMLInputElement>(null);
  return (
    <>
      <button type="button" onClick={() => input.current?.click()}>Load a file</button>
      <input
        ref={input} type="file" accept=".json,application/json" aria-label="Layout file" hidden
        onChange={(event) => {
          const chosen = event.target.files?.[0];
          if (chosen) onFile(chosen);
          event.target.value = '';
        }}
      />
    </>
  );
}

function Bar({ robot, all, onAdd }: { robot: string; all: Plots; onAdd: () => void }) {
  const { panels, note, keep, load } = all;
  return (
    <div className="bar">
      <ActionButton type="button" className="primary" whyNot={panels.length < mostPanels ? '' : mostPanels + ' panels are the most'} onClick={onAdd}>Add a panel</ActionButton>
      <ActionButton type="button" tip whyNot={panels.length > 0 ? '' : 'there is no panel to save'} onClick={() => download(robot + '.layout.json', layoutText(panels))}>Save to a file</ActionButton>
      <LoadButton onFile={(file) => void load(file)} />
      <span className="quiet">{panels.length} panels; this browser keeps them.</span>
      {note && (
        <span role="status" className={note.bad ? 'bad' : 'good'}>
          {note.text} {note.before && <button type="button" className="small" onClick={() => keep(note.before ?? [])}>Take back</button>}
        </span>
      )}
    </div>
  );
}

/** Panels that plot, draw or map the samples of ports, arranged as the user likes. */
export function PlotsView({ status }: { status: Status }) {
  const { robot } = useConnection();
  const all = usePlots();
  const { panels, keep, move, change, remove } = all;
  const [editing, setEditing] = useState<Panel | 'new' | null>(null);
  const finish = (chosen: Chosen) => {
    if (editing === 'new') keep([...panels, { id: newId(), columns: 1, rows: 1, seconds: 30, ...chosen }]);
    else if (editing) keep(panels.map((one) => (one.id === editing.id ? { ...one, ...chosen } : one)));
    setEditing(null);
  };
  const drop = (id: number, at: number) => {
    const from = panels.findIndex((one) => one.id === id);
    if (from >= 0) move(from, at);
  };
  return (
    <section className="view" aria-label="Plots">
      <Bar robot={robot} all={all} onAdd={() => setEditing('new')} />
      {panels.length === 0 && <p className="empty">No panel yet: curves over time, lists, images and maps of what tasks write to their ports are shown here. Press <em>Add a panel</em>, then choose a port and its fields.</p>}
      <div className="panels">
        {panels.map((panel, index) => (
          <PanelFrame
            key={panel.id} panel={panel} onChange={change} onEdit={() => setEditing(panel)}
            onMove={(step) => move(index, index + step)} onRemove={() => remove(panel)} onDrop={(id) => drop(id, index)}
          />
        ))}
      </div>
      {editing && <PanelDialog status={status} panel={editing === 'new' ? null : editing} onClose={() => setEditing(null)} onDone={finish} />}
    </section>
  );
}
