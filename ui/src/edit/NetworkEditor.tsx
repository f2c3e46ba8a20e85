// SPDX-License-Identifier: Apache-2.0
import { useMemo, useState } from 'react';
import { reason } from '../reason';
import type { Drafts } from './drafts';
import { EditGraph } from './EditGraph';
import { found, newId, type Models } from './models';
import { TaskForm, type Edits } from './TaskForm';
import { addConnection, addTask, networkIn, removeConnection, removeProperty, removeTask, renameTask, setProperty, type NetworkText } from './text';
import { useLastGood } from './useLastGood';


function Palette({ models, onAdd }: { models: Models; onAdd: (component: string) => void }) {
  const [words, setWords] = useState('');
  const shown = found(models, words);
  return (
    <details className="palette">
      <summary>Add a task</summary>
      <input type="search" aria-label="Find components" placeholder="Find components" value={words} onChange={(event) => setWords(event.target.value)} />
      <ul className="plain">
        {shown.slice(0, 100).map((model) => (
          <li key={model.name}>
            <button type="button" className="line documented" onClick={() => onAdd(model.name)}>
              <span>{model.name}</span>
              {model.doc && <small className="quiet">{model.doc}</small>}
            </button>
          </li>
        ))}
      </ul>
      {shown.length > 100 && <p className="quiet">{shown.length - 100} more; search for them.</p>}
    </details>
  );
}

interface Props {
  path: string;
  text: string;
  drafts: Drafts;
  models: Models;
  /** Nothing can be changed. */
  fixed: boolean;
}

/** The task, or the connection by its index, that is selected. */
function useSelection() {
  const [task, setTask] = useState<string | null>(null);
  const [link, setLink] = useState<number | null>(null);
  return { task, link, setTask, setLink };
}
type Selection = ReturnType<typeof useSelection>;

/** Changes the text; what is wrong, or null. */
type Edit = (change: (before: string) => string) => string | null;

function useEdit(path: string, drafts: Drafts, closed: boolean): { edit: Edit; problem: string } {
  const [problem, setProblem] = useState('');
  const edit: Edit = (change) => {
    try {
      if (closed) throw new Error('this text cannot be edited in the graph now');
      drafts.replace(path, change(drafts.get(path)?.state.doc.toString() ?? ''));
      setProblem('');
      return null;
    } catch (error) {
      setProblem(reason(error));
      return reason(error);
    }
  };
  return { edit, problem };
}

/** The edits of tasks and connections; the selection follows them. */
function editsOf(edit: Edit, { setTask, setLink }: Selection): Edits {
  return {
    setProperty: (id, name, yaml) => edit((before) => setProperty(before, id, name, yaml)),
    removeProperty: (id, name) => void edit((before) => removeProperty(before, id, name)),
    connect: (from, to) => void edit((before) => addConnection(before, from, to)),
    disconnect: (index) => {
      if (edit((before) => removeConnection(before, index)) === null) setLink(null);
    },
    removeTask: (id) => {
      if (edit((before) => removeTask(before, id)) === null) setTask(null);
    },
    renameTask: (id, name) => {
      const refused = edit((before) => renameTask(before, id, name));
      if (refused === null) setTask(name);
      return refused;
    },
  };
}

/** A network as a graph, beside its text, and the panel of the task that is selected. */
export function NetworkEditor({ path, text, drafts, models, fixed }: Props) {
  const now = useMemo(() => networkIn(text), [text]);
  const network = useLastGood<NetworkText>(now);
  const closed = fixed || !now?.editable;
  const selection = useSelection();
  const { task, link, setTask, setLink } = selection;
  const { edit, problem } = useEdit(path, drafts, closed);
  if (!network) return null;
  const edits = editsOf(edit, selection);
  const select = (id: string | null) => {
    setTask(id);
    setLink(null);
    const at = network.tasks.find((one) => one.id === id)?.at;
    if (at !== undefined) drafts.jump(path, at);
  };
  const add = (component: string) => {
    const id = newId(network, component);
    if (edit((before) => addTask(before, id, component)) === null) setTask(id);
  };
  const chosen = link === null ? undefined : network.connections[link];
  return (
    <>
      <div className="half">
        <div className="bar">
          {!closed && <Palette models={models} onAdd={add} />}
          {!now && <span className="badge warn">the text has errors: the graph is as before</span>}
          {now && !now.editable && <span className="quiet">This form of file is edited as text.</span>}
          {chosen && !closed && link !== null && <button type="button" onClick={() => edits.disconnect(link)}>Remove {chosen.from} → {chosen.to}</button>}
          {problem && <span className="bad" role="alert">{problem}</span>}
        </div>
        <EditGraph
          network={network} models={models} fixed={closed} task={task} connection={link} onTask={select}
          onConnection={(index) => [setTask(null), setLink(index)]} onConnect={edits.connect}
          onRemove={() => (link !== null ? edits.disconnect(link) : task !== null && edits.removeTask(task))}
        />
      </div>
      {task !== null && <TaskForm key={task} id={task} network={network} models={models} edits={edits} fixed={closed} onClose={() => setTask(null)} />}
    </>
  );
}
