// SPDX-License-Identifier: Apache-2.0
import { redoDepth, undoDepth } from '@codemirror/commands';
import { useCallback, useDeferredValue, useEffect, useMemo, useState, useSyncExternalStore } from 'react';
import { ActionButton } from '../ActionButton';
import { restOfAddress } from '../address';
import { Name } from '../Name';
import { reason } from '../reason';
import type { Json } from '../robot/change';
import { useConnection, useLink } from '../robot/hooks';
import { ListPane } from '../panes/Panel';
import { Splitter } from '../panes/Splitter';
import { draftsOf, type Draft, type Drafts, type FileEntry } from './drafts';
import './edit.css';
import { FileActions, NewFile } from './FileActions';
import { MissionEditor } from './MissionEditor';
import { modelsOf, type Models } from './models';
import { NetworkEditor } from './NetworkEditor';
import { semanticDraftsOf } from './semantic_drafts';
import { TextEditor } from './TextEditor';


/** The files and component models, read when the view opens. */
function useFiles() {
  const connection = useConnection();
  const link = useLink();
  const [files, setFiles] = useState<FileEntry[]>([]);
  const [models, setModels] = useState<Models>(new Map());
  const [error, setError] = useState('');
  const [complete, setComplete] = useState(true);
  const [asked, setAsked] = useState(0);
  const again = useCallback(() => setAsked((count) => count + 1), []);
  useEffect(() => {
    if (link !== 'open') return;
    let current = true;
    const ask = async () => {
      try {
        const list = (await connection.call('files')) as { files: Json; complete: boolean };
        const known = modelsOf(await connection.call('models'));
        if (current) [setFiles(list.files as unknown as FileEntry[]), setComplete(list.complete), setModels(known), setError('')];
      } catch (problem) {
        if (current) setError(reason(problem));
      }
    };
    void ask();
    return () => {
      current = false;
    };
  }, [connection, link, asked]);
  return { files, complete, models, error, again };
}

const kinds = [
  { title: 'Files', kinds: ['robot', 'network'] },
  { title: 'Missions', kinds: ['mission'] },
  { title: 'RAFCON', kinds: ['rafcon'] },
];

interface FileListProps {
  files: FileEntry[];
  complete: boolean;
  chosen: string | null;
  drafts: Drafts;
  onChoose: (path: string) => void;
  onFiles: (path: string | null) => void;
}

function FileList({ files, complete, chosen, drafts, onChoose, onFiles }: FileListProps) {
  const connection = useConnection();
  const semantic = semanticDraftsOf(connection);
  useSyncExternalStore(semantic.subscribe, () => files.map((file) => semantic.hasUnsaved(file.path)).join());
  return (
    <ListPane label="Files">
      {kinds.map(({ title, kinds: shown }) => {
        const those = files.filter((file) => shown.includes(file.kind));
        if (those.length === 0 && title !== 'Files') return null;
        return (
          <div key={title}>
            <h2>{title}</h2>
            <ul className="plain">
              {those.map((file) => (
                <li key={file.path}>
                  <ActionButton type="button" className="line" aria-pressed={chosen === file.path} whyNot={file.problem} onClick={() => onChoose(file.path)}>
                    <span><Name text={file.path} /></span>
                    {(drafts.isUnsaved(drafts.get(file.path)) || semantic.hasUnsaved(file.path)) && <span className="badge warn">unsaved</span>}
                  </ActionButton>
                </li>
              ))}
            </ul>
          </div>
        );
      })}
      {!complete && <p className="quiet">There are more files than are looked for.</p>}
      {connection.mayOperate && files.length > 0 && <NewFile files={files} drafts={drafts} onFiles={onFiles} />}
    </ListPane>
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
  const asks = busy ? 'the robot is being asked' : '';
  return (
    <>
      <ActionButton type="button" tip whyNot={asks} onClick={() => void ask('plan_files')}>Plan</ActionButton>
      <ActionButton type="button" tip whyNot={asks || (unsaved ? 'save the changes first' : '')} title="The robot takes the files as they are saved" onClick={() => void ask('apply_files')}>Apply</ActionButton>
      {note && <output className={note.bad ? 'bad' : 'good'}>{note.text}</output>}
    </>
  );
}

export function EditView() {
  const connection = useConnection();
  const drafts = draftsOf(connection);
  const { files, complete, models, error, again } = useFiles();
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
  useEffect(() => {
    const wanted = restOfAddress(window.location.hash, 'edit');
    if (wanted !== '') choose(wanted);
  }, []); // once: afterwards a file is chosen from the list
  /** To be called after files were created, renamed or deleted. */
  const onFiles = (wanted: string | null) => {
    again();
    if (wanted === null) setPath((lastPath = null));
    else choose(wanted);
  };
  return (
    <div className="view switch edit">
      <FileList files={files} complete={complete} chosen={path} drafts={drafts} onChoose={choose} onFiles={onFiles} />
      {(error || problem) && <p className="bad" role="alert">{error || problem}</p>}
      {draft ? (
        <DraftView key={draft.path} draft={draft} drafts={drafts} models={models} files={files} onFiles={onFiles} anyUnsaved={files.some((file) => drafts.isUnsaved(drafts.get(file.path)))} />
      ) : (
        <NoFile mayOperate={connection.mayOperate} />
      )}
    </div>
  );
}

function NoFile({ mayOperate }: { mayOperate: boolean }) {
  return (
    <p className="empty">
      Choose a file at the left: its text and its graph are shown here side by side.{' '}
      {mayOperate && <><em>New controller</em> and <em>New mission</em> make one. What is edited changes the robot only when it is saved and applied (<code>segue apply</code>).</>}
    </p>
  );
}

/** Shown again when the view is. */
let lastPath: string | null = null;

function DraftView({ draft, drafts, models, files, anyUnsaved, onFiles }: { draft: Draft; drafts: Drafts; models: Models; files: FileEntry[]; anyUnsaved: boolean; onFiles: (path: string | null) => void }) {
  const connection = useConnection();
  const path = draft.path;
  const text = useDeferredValue(draft.state.doc.toString()); // typing goes before drawing
  const unsaved = drafts.isUnsaved(draft);
  const file = files.find((one) => one.path === path);
  const fixed = !connection.mayOperate || draft.isReadOnly;
  const isMission = useMemo(() => /^["']?mission["']?:/m.test(text), [text]);
  return (
    <section className="main" aria-label={'Edit ' + path}>
      <div className="bar">
        <strong>{path}</strong>
        {fixed ? <span className="badge">read only</span> : (
          <>
            <ActionButton type="button" className="primary" tip whyNot={draft.saving ? 'is being saved' : unsaved ? '' : 'nothing is unsaved'} onClick={() => void drafts.save(path)} title="Ctrl+S in the text">Save</ActionButton>
            <ActionButton type="button" tip whyNot={undoDepth(draft.state) > 0 ? '' : 'nothing to undo'} onClick={() => drafts.undo(path)}>Undo</ActionButton>
            <ActionButton type="button" tip whyNot={redoDepth(draft.state) > 0 ? '' : 'nothing to redo'} onClick={() => drafts.redo(path)}>Redo</ActionButton>
            <Apply unsaved={anyUnsaved} />
          </>
        )}
        <span role="status" className="quiet">{unsaved ? 'unsaved changes' : draft.isReadOnly ? '' : 'as in the file'}</span>
        {connection.mayOperate && file && <FileActions file={file} files={files} draft={draft} drafts={drafts} onFiles={onFiles} />}
      </div>
      {file?.kind === 'rafcon' && (
        <p className="quiet note">A state machine of RAFCON, as the mission that it becomes. {connection.mayOperate && 'The semantic data of its states can be edited in their panels. '}{draft.notes.length > 0 && 'What could not be kept: ' + draft.notes.join('; ')}</p>
      )}
      <Conflict draft={draft} drafts={drafts} />
      <div className="halves">
        <div className="half">
          <TextEditor drafts={drafts} path={path} />
          <Problems draft={draft} drafts={drafts} />
        </div>
        <Splitter name="text" label="Width of the text" axis="x" sized="before" />
        {isMission ? <MissionEditor path={path} text={text} drafts={drafts} fixed={fixed} folders={file?.kind === 'rafcon' ? draft.folders : null} /> : <NetworkEditor path={path} text={text} drafts={drafts} models={models} fixed={fixed} />}
      </div>
    </section>
  );
}
