// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from 'react';
import { ActionButton } from '../ActionButton';
import { addressOf } from '../address';
import { reason } from '../reason';
import { useConnection } from '../robot/hooks';
import { draftsOf, type FileEntry } from './drafts';
import { addWrittenTask } from './text';

/** The networks of the robot, asked for once. */
function useNetworks() {
  const connection = useConnection();
  const [networks, setNetworks] = useState<string[]>([]);
  const [problem, setProblem] = useState('');
  useEffect(() => {
    let current = true;
    connection.call('files').then(
      (answer) => {
        const { files } = answer as unknown as { files: FileEntry[] };
        if (current) setNetworks(files.filter(({ kind, problem: why }) => kind === 'network' && why === '').map(({ path }) => path));
      },
      (error: unknown) => {
        if (current) setProblem(reason(error));
      },
    );
    return () => {
      current = false;
    };
  }, [connection]);
  return { networks, problem };
}

/** Adds a task to a network as it is edited; nothing is saved by that. */
export function AddToNetwork({ written }: { written: string }) {
  const drafts = draftsOf(useConnection());
  const { networks, problem } = useNetworks();
  const [chosen, setChosen] = useState('');
  const [added, setAdded] = useState<{ id: string; path: string } | null>(null);
  const [failure, setFailure] = useState('');
  const path = networks.includes(chosen) ? chosen : (networks[0] ?? '');
  const add = async () => {
    setAdded(null);
    try {
      await drafts.open(path);
      const { id, text } = addWrittenTask(drafts.get(path)?.state.doc.toString() ?? '', written);
      drafts.replace(path, text);
      [setAdded({ id, path }), setFailure('')];
    } catch (error) {
      setFailure(reason(error));
    }
  };
  return (
    <>
      <ActionButton type="button" whyNot={path === '' ? 'the robot has no network that can be edited here' : ''} title="Nothing is saved by that" onClick={() => void add()}>Add to</ActionButton>
      {path !== '' && (
        <select aria-label="Network to add it to" value={path} onChange={(event) => setChosen(event.target.value)}>
          {networks.map((one) => <option key={one}>{one}</option>)}
        </select>
      )}
      {added && <output className="good">added as {added.id}, not saved yet: <a href={addressOf('edit', added.path)}>edit {added.path}</a></output>}
      {(failure || problem) && <output className="bad">{failure || problem}</output>}
    </>
  );
}
