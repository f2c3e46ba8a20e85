// SPDX-License-Identifier: Apache-2.0
import { useDeferredValue, useEffect, useMemo, useRef, useState, useSyncExternalStore } from 'react';
import type { Json } from '../robot/change';
import { useConnection, useLink } from '../robot/hooks';
import { draftsOf, type Draft, type Drafts, type FileEntry } from './drafts';
import './edit.css';
import { EditGraph } from './EditGraph';
import { found, modelsOf, newId, type Models } from './models';
import { TaskForm, type Edits } from './TaskForm';
import { addConnection, addTask, networkIn, removeConnection, removeProperty, removeTask, renameTask, setProperty, type NetworkText } from './text';
import { TextEditor } from './TextEditor';

const reason = (error: unknown) => (error instanceof Error ? error.message : String(error));

/** The files and component models, read when the view opens. */
function useFiles() {
  const connection = useConnection();
  const link = useLink();
  const [files, setFiles] = useState<FileEntry[]>([]);
  const [models, setModels] = useState<Models>(new Map());
  const [error, setError] = useState('');
  useEffect(() => {
    if (link !== 'open') return;
    let current = true;
    const ask = async () => {
      try {
        const list = (await connection.call('files')) as { files: Json };
        const known = modelsOf(await connection.call('models'));
        if (current) [setFiles(list.files as unknown as FileEntry[]), setModels(known), setError('')];
      } catch (problem) {
        if (current) setError(reason(problem));
      }
    };
    void ask();
    return () => {
      current = false;
    };
  }, [connection, link]);
  return { files, models, error };
}

function FileList({ files, chosen, drafts, onChoose }: { files: FileEntry[]; chosen: string | null; drafts: Drafts; onChoose: (path: string) => void }) {
  return (
    <section className="controllers" aria-label="Files">
      <h2>Files</h2>
      <ul className="plain">
        {files.map((file) => (
          <li key={file.path}>
            <button type="button" className="line" aria-pressed={chosen === file.path} disabled={file.problem !== ''} title={file.problem} onClick={() => onChoose(file.path)}>
              <span>{file.path}</span>
              {drafts.isUnsaved(drafts.get(file.path)) && <span className="badge warn">unsaved</span>}
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}

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

function Conflict({ draft, drafts }: { draft: Draft; drafts: Drafts }) {
  return (
    <>
      {draft.conflict && (
        <div className="banner" role="alert">
          {draft.conflict}{' '}
          <button type="button" onClick={() => void drafts.readAgain(draft.path, false)}>Read again</button>{' '}
          <button type="button" onClick={() => void drafts.readAgain(draft.path, true)}>Read again, keep mine as text to copy</button>
        </div>
      )}
      {draft.kept !== null && (
        <div className="kept">
          <label htmlFor="kept-text">Your text of before</label>
          <textarea id="kept-text" readOnly value={draft.kept} rows={6} />
          <button type="button" onClick={() => void navigator.clipboard.writeText(draft.kept ?? '')}>Copy</button>{' '}
          <button type="button" onClick={() => drafts.dropKept(draft.path)}>Close</button>
        </div>
      )}
    </>
  );
}

function Problems({ draft, drafts }: { draft: Draft; drafts: Drafts }) {
  const problems = draft.problems;
  return (
    <section className="problems" aria-label="Problems" aria-live="polite">
      {draft.error && <p className="bad" role="alert">{draft.error}</p>}
      {problems === null ? <p className="quiet">…</p> : problems.length === 0 && <p className="good">No problems</p>}
      <ul className="plain">
        {(problems ?? []).map((problem, index) => (
          <li key={index}>
            <button
              type="button" className="line"
              onClick={() => [drafts.jump(draft.path, drafts.lineStart(draft.path, problem.line, problem.column)), drafts.focus()]}
            >
              <span className={problem.severity === 'error' ? 'bad' : ''}>
                {problem.line > 0 ? problem.line + ':' + problem.column + ' ' : ''}{problem.severity}: {problem.message}
              </span>
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}

interface Applied {
  outcome: string;
  error?: string;
  changes?: { controller: string; kind?: string; change?: string }[];
  diagnostics?: { message: string }[];
}

/** `segue apply`: the robot takes the files as they were saved. */
function Apply({ unsaved }: { unsaved: boolean }) {
  const connection = useConnection();
  const [busy, setBusy] = useState(false);
  const [note, setNote] = useState<{ text: string; bad: boolean } | null>(null);
  const ask = async (verb: string) => {
    setBusy(true);
    try {
      const answer = (await connection.call(verb, {})) as unknown as Applied;
      const names = (answer.changes ?? []).map((change) => change.controller).join(', ');
      const bad = answer.outcome !== 'done';
      const why = answer.error ?? (answer.diagnostics ?? []).map((one) => one.message).join('; ');
      setNote({ bad, text: bad ? answer.outcome + (why ? ': ' + why : '') : (verb === 'plan_files' ? 'would change: ' : 'applied: ') + (names || 'nothing') });
    } catch (error) {
      setNote({ bad: true, text: reason(error) });
    }
    setBusy(false);
  };
  return (
    <>
      <button type="button" disabled={busy} onClick={() => void ask('plan_files')}>Plan</button>
      <button type="button" disabled={busy || unsaved} title={unsaved ? 'There are unsaved changes' : 'The robot takes the files as they are saved'} onClick={() => void ask('apply_files')}>Apply</button>
      {note && <output className={note.bad ? 'bad' : 'good'}>{note.text}</output>}
    </>
  );
}

export function EditView() {
  const connection = useConnection();
  const drafts = draftsOf(connection);
  const { files, models, error } = useFiles();
  const [path, setPath] = useState<string | null>(lastPath);
  const [problem, setProblem] = useState('');
  const draft = useSyncExternalStore(drafts.subscribe, () => drafts.get(path));
  const choose = (wanted: string) => {
    setProblem('');
    drafts.open(wanted).then(
      () => setPath((lastPath = wanted)),
      (refused: unknown) => setProblem(reason(refused)),
    );
  };
  return (
    <div className="view switch edit">
      <FileList files={files} chosen={path} drafts={drafts} onChoose={choose} />
      {(error || problem) && <p className="bad" role="alert">{error || problem}</p>}
      {draft ? (
        <DraftView key={draft.path} draft={draft} drafts={drafts} models={models} anyUnsaved={files.some((file) => drafts.isUnsaved(drafts.get(file.path)))} />
      ) : (
        <p className="empty">Choose a file. What is edited here changes the robot only when it is saved and applied.</p>
      )}
    </div>
  );
}
/** Shown again when the view is. */
let lastPath: string | null = null;

function DraftView({ draft, drafts, models, anyUnsaved }: { draft: Draft; drafts: Drafts; models: Models; anyUnsaved: boolean }) {
  const connection = useConnection();
  const path = draft.path;
  const text = useDeferredValue(draft.state.doc.toString()); // typing goes before drawing
  const unsaved = drafts.isUnsaved(draft);
  const now = useMemo(() => networkIn(text), [text]);
  const lastGood = useRef<NetworkText | null>(null);
  if (now) lastGood.current = now;
  const network = now ?? lastGood.current;
  const fixed = connection.role !== 'operate';
  const closed = fixed || !now?.editable;
  const [task, setTask] = useState<string | null>(null);
  const [chosen, setChosen] = useState<number | null>(null);
  const [problem, setProblem] = useState('');

  /** What is wrong, or null. */
  const edit = (change: (before: string) => string): string | null => {
    try {
      if (closed) throw new Error('this text cannot be edited in the graph now');
      drafts.replace(path, change(draft.state.doc.toString()));
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

  return (
    <>
      <section className="main" aria-label={'Edit ' + path}>
        <div className="bar">
          <strong>{path}</strong>
          {fixed ? <span className="badge">read only</span> : (
            <>
              <button type="button" className="primary" disabled={!unsaved || draft.saving} onClick={() => void drafts.save(path)} title="Ctrl+S in the text">Save</button>
              <button type="button" onClick={() => drafts.undo(path)}>Undo</button>
              <button type="button" onClick={() => drafts.redo(path)}>Redo</button>
              <Apply unsaved={anyUnsaved} />
            </>
          )}
          <span role="status" className="quiet">{unsaved ? 'unsaved changes' : 'as in the file'}</span>
        </div>
        <Conflict draft={draft} drafts={drafts} />
        <div className="halves">
          <div className="half">
            <TextEditor drafts={drafts} path={path} />
            <Problems draft={draft} drafts={drafts} />
          </div>
          {network && (
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
          )}
        </div>
      </section>
      {task !== null && network && (
        <TaskForm key={task} id={task} network={network} models={models} edits={edits} fixed={closed} onClose={() => setTask(null)} />
      )}
    </>
  );
}
