// SPDX-License-Identifier: Apache-2.0
import { useState, type FormEvent } from 'react';
import { ActionButton } from '../ActionButton';
import { reason } from '../reason';
import { useConnection } from '../robot/hooks';
import type { Connection } from '../robot/connection';
import type { Draft, Drafts, FileEntry } from './drafts';
import { newMission, newNetwork } from './mission_edits';
import { forgetFile, nameFile, renameFile } from './robot_text';

const sectionOf = (kind: FileEntry['kind']) => (kind === 'network' ? 'controllers' : 'missions');

/** The robot file's part of a change of files; nothing where it stays as it is. */
async function robotChange(connection: Connection, drafts: Drafts, files: FileEntry[], change: (text: string) => string): Promise<Record<string, string>> {
  const robot = files.find((file) => file.kind === 'robot');
  if (!robot) return {};
  if (drafts.isUnsaved(drafts.get(robot.path))) throw new Error('save ' + robot.path + ' first: it has to name the files');
  const { text, version } = (await connection.call('read_file', { path: robot.path })) as { text: string; version: string };
  const changed = change(text);
  return changed === text ? {} : { robot_text: changed, robot_version: version };
}
/** The robot file may be another one now. */
async function readRobotAgain(drafts: Drafts, files: FileEntry[]): Promise<void> {
  const robot = files.find((file) => file.kind === 'robot');
  if (robot && drafts.get(robot.path)) await drafts.readAgain(robot.path, false);
}

/** "missions/fetch.yaml": "fetch". */
const nameOf = (path: string) => (path.split('/').pop() ?? '').replace(/\.ya?ml$/, '');
function placeOf(kind: 'network' | 'mission', files: FileEntry[]): string {
  const beside = files.find((file) => file.kind === kind && file.path.includes('/') && !file.path.startsWith('..'))?.path ?? '';
  return beside.slice(0, beside.lastIndexOf('/') + 1) + (kind === 'network' ? 'new_controller.yaml' : 'new_mission.yaml');
}

/** Asks for the path of a file; what is wrong stands below. */
function PathForm({ label, first, action, onDone, onClose }: { label: string; first: string; action: string; onDone: (path: string) => Promise<void>; onClose: () => void }) {
  const [path, setPath] = useState(first);
  const [problem, setProblem] = useState('');
  const [busy, setBusy] = useState(false);
  const submit = (event: FormEvent) => {
    event.preventDefault();
    setBusy(true);
    onDone(path.trim()).then(onClose, (error: unknown) => [setProblem(reason(error)), setBusy(false)]);
  };
  return (
    <form
      className="file-form" onSubmit={submit}
      onKeyDown={(event) => {
        if (event.key === 'Escape') onClose();
      }}
    >
      <input aria-label={label} value={path} spellCheck={false} autoFocus onChange={(event) => setPath(event.target.value)} />
      <ActionButton type="submit" className="primary" whyNot={busy ? 'is being done' : path.trim() === '' ? 'needs a path' : ''}>{action}</ActionButton>
      <button type="button" onClick={onClose}>Cancel</button>
      {problem && <output className="bad">{problem}</output>}
    </form>
  );
}

export function NewFile({ files, drafts, onFiles }: { files: FileEntry[]; drafts: Drafts; onFiles: (path: string) => void }) {
  const connection = useConnection();
  const [kind, setKind] = useState<'network' | 'mission' | null>(null);
  const create = async (path: string) => {
    const text = kind === 'network' ? newNetwork(nameOf(path)) : newMission(nameOf(path));
    const robot = kind === 'network' ? await robotChange(connection, drafts, files, (before) => nameFile(before, 'controllers', path)) : {};
    await connection.call('create_file', { path, text, ...robot });
    await readRobotAgain(drafts, files);
    onFiles(path);
  };
  if (kind !== null) return <PathForm key={kind} label={kind === 'network' ? 'File of the new controller' : 'File of the new mission'} first={placeOf(kind, files)} action="Create" onDone={create} onClose={() => setKind(null)} />;
  return (
    <p className="new-files">
      <button type="button" onClick={() => setKind('network')}>New controller</button>{' '}
      <button type="button" onClick={() => setKind('mission')}>New mission</button>
    </p>
  );
}

interface Props {
  file: FileEntry;
  files: FileEntry[];
  draft: Draft;
  drafts: Drafts;
  onFiles: (path: string | null) => void;
}

/** The actions on the file; each rejects with its problem. */
function useFileVerbs({ file, files, draft, drafts, onFiles }: Props) {
  const connection = useConnection();
  const version = { path: file.path, version: draft.version };
  const replaced = async (path: string | null) => {
    drafts.forget(file.path);
    await readRobotAgain(drafts, files);
    onFiles(path);
  };
  const rename = async (to: string) => {
    const robot = await robotChange(connection, drafts, files, (before) => renameFile(before, sectionOf(file.kind), file.path, to));
    await connection.call('rename_file', { ...version, to, ...robot });
    await replaced(to);
  };
  const remove = async () => {
    const robot = await robotChange(connection, drafts, files, (before) => forgetFile(before, sectionOf(file.kind), file.path));
    await connection.call('delete_file', { ...version, ...robot });
    await replaced(null);
  };
  const save = async (path: string) => {
    await connection.call('create_file', { path, text: draft.state.doc.toString() });
    onFiles(path);
  };
  return { rename, remove, save };
}

function DeleteQuestion({ path, onDelete, onClose }: { path: string; onDelete: () => Promise<void>; onClose: () => void }) {
  const [problem, setProblem] = useState('');
  return (
    <span role="group" aria-label={'Delete ' + path} className="file-form">
      Delete {path}? It does not come back by Undo.{' '}
      <button type="button" onClick={() => onDelete().catch((error: unknown) => setProblem(reason(error)))}>Delete the file</button>{' '}
      <button type="button" autoFocus onClick={onClose}>Keep it</button>
      {problem && <output className="bad">{problem}</output>}
    </span>
  );
}

/** Of the file that is edited: another name, delete; of a machine of RAFCON: save as a mission. */
export function FileActions(props: Props) {
  const { file, draft, drafts } = props;
  const { rename, remove, save } = useFileVerbs(props);
  const [asked, setAsked] = useState<'rename' | 'delete' | 'save' | null>(null);
  const close = () => setAsked(null);
  if (file.kind === 'robot') return null;
  if (asked === 'save') return <PathForm label="File of the mission" first={nameOf(file.path).replace(/[^A-Za-z0-9_-]+/g, '_') + '.yaml'} action="Save as a mission" onDone={save} onClose={close} />;
  if (asked === 'rename') return <PathForm label="New name of the file" first={file.path} action="Rename" onDone={rename} onClose={close} />;
  if (asked === 'delete') return <DeleteQuestion path={file.path} onDelete={remove} onClose={close} />;
  if (file.kind === 'rafcon') return <button type="button" onClick={() => setAsked('save')}>Save as a mission …</button>;
  const whyNot = drafts.isUnsaved(draft) ? 'save the changes first' : '';
  return (
    <>
      <ActionButton type="button" tip whyNot={whyNot} onClick={() => setAsked('rename')}>Rename …</ActionButton>
      <ActionButton type="button" tip whyNot={whyNot} onClick={() => setAsked('delete')}>Delete …</ActionButton>
    </>
  );
}
