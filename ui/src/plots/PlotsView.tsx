// SPDX-License-Identifier: Apache-2.0
import { useRef, useState } from 'react';
import { ActionButton } from '../ActionButton';
import { reason } from '../reason';
import { useConnection } from '../robot/hooks';
import type { Status } from '../robot/types';
import { layoutText, mostPanels, mostPorts, newId, parseLayout, portsOf, type Panel } from './layout';
import { PanelDialog, type Chosen } from './PanelDialog';
import { PanelFrame } from './PanelFrame';
import { download, keepLayout, storedLayout } from './stored';
import './plots.css';

const longestFile = 1 << 20;

interface Note {
  text: string;
  bad: boolean;
  /** The panels that a loaded layout has replaced. */
  before?: Panel[];
}

/** The panels that this browser keeps for the robot, and what is told of the last change. */
function usePanels(robot: string) {
  const [first] = useState(() => storedLayout(robot));
  const [panels, setPanels] = useState<Panel[]>(first.panels);
  const [note, setNote] = useState<Note | null>(first.problem ? { text: first.problem, bad: true } : null);
  const keep = (next: Panel[], told: Note | null = null) => {
    const ports = portsOf(next).size;
    if (ports > mostPorts) return setNote({ text: 'That would show ' + ports + ' ports; ' + mostPorts + ' are the most.', bad: true });
    setPanels(next);
    const problem = keepLayout(robot, next);
    setNote(problem ? { text: problem, bad: true } : told);
  };
  const load = async (chosen: File) => {
    try {
      if (chosen.size > longestFile) throw new Error('it is larger than 1 MiB');
      const next = parseLayout(await chosen.text());
      keep(next, { text: 'Loaded ' + chosen.name + '.', bad: false, before: panels });
    } catch (error) {
      setNote({ text: chosen.name + ' was not loaded: ' + reason(error), bad: true });
    }
  };
  const move = (from: number, to: number) => {
    const next = [...panels];
    const [panel] = next.splice(from, 1);
    if (!panel || to < 0 || to > next.length) return;
    next.splice(to, 0, panel);
    keep(next);
  };
  const change = (changed: Panel) => keep(panels.map((one) => (one.id === changed.id ? changed : one)));
  const remove = (panel: Panel) => keep(panels.filter((one) => one.id !== panel.id), { text: 'Removed ' + panel.title + '.', bad: false, before: panels });
  return { panels, note, keep, load, move, change, remove };
}
type Panels = ReturnType<typeof usePanels>;

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

function Bar({ robot, all, onAdd }: { robot: string; all: Panels; onAdd: () => void }) {
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
  const all = usePanels(robot);
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
