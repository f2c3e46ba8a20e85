// SPDX-License-Identifier: Apache-2.0
import { useMemo, useRef, useState } from 'react';
import type { Drafts } from './drafts';
import { EditGraph } from './EditGraph';
import { found, newId, type Models } from './models';
import { TaskForm, type Edits } from './TaskForm';
import { addConnection, addTask, networkIn, removeConnection, removeProperty, removeTask, renameTask, setProperty, type NetworkText } from './text';

const reason = (error: unknown) => (error instanceof Error ? error.message : String(error));

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

/** A network as a graph, beside its text, and the panel of the task that is selected. */
export function NetworkEditor({ path, text, drafts, models, fixed }: Props) {
  const now = useMemo(() => networkIn(text), [text]);
  const lastGood = useRef<NetworkText | null>(null);
  if (now) lastGood.current = now;
  const network = now ?? lastGood.current;
  const closed = fixed || !now?.editable;
  const [task, setTask] = useState<string | null>(null);
  const [chosen, setChosen] = useState<number | null>(null);
  const [problem, setProblem] = useState('');

  /** Changes the text; the problem where that fails, or null. */
  const edit = (change: (before: string) => string): string | null => {
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
  const select = (id: string | null) => {
    setTask(id);
    setChosen(null);
    const at = network?.tasks.find((one) => one.id === id)?.at;
    if (at !== undefined) drafts.jump(path, at);
  };
  const edits: Edits = {
    setProperty: (id, name, yaml) => edit((before) => setProperty(before, id, name, yaml)),
    removeProperty: (id, name) => void edit((before) => removeProperty(before, id, name)),
    connect: (from, to) => void edit((before) => addConnection(before, from, to)),
    disconnect: (index) => {
      if (edit((before) => removeConnection(before, index)) === null) setChosen(null);
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
  const add = (component: string) => {
    if (!network) return;
    const id = newId(network, component);
    if (edit((before) => addTask(before, id, component)) === null) setTask(id);
  };
  const link = chosen === null ? null : network?.connections[chosen];
  if (!network) return null;
  return (
    <>
      <div className="half">
        <div className="bar">
          {!closed && <Palette models={models} onAdd={add} />}
          {!now && <span className="badge warn">the text has errors: the graph is as before</span>}
          {now && !now.editable && <span className="quiet">This form of file is edited as text.</span>}
          {link && !closed && chosen !== null && (
            <button type="button" onClick={() => edits.disconnect(chosen)}>Remove {link.from} → {link.to}</button>
          )}
          {problem && <span className="bad" role="alert">{problem}</span>}
        </div>
        <EditGraph
          network={network} models={models} fixed={closed} task={task} connection={chosen} onTask={select}
          onConnection={(index) => [setTask(null), setChosen(index)]} onConnect={edits.connect}
          onRemove={() => (chosen !== null ? edits.disconnect(chosen) : task !== null && edits.removeTask(task))}
        />
      </div>
      {task !== null && (
        <TaskForm key={task} id={task} network={network} models={models} edits={edits} fixed={closed} onClose={() => setTask(null)} />
      )}
    </>
  );
}
