// SPDX-License-Identifier: Apache-2.0
import { useEffect, useId, useState, useSyncExternalStore, type FormEvent } from 'react';
import { ActionButton } from '../ActionButton';
import { isMap, type Json, type JsonMap } from '../robot/change';
import { reason } from '../reason';
import { useConnection } from '../robot/hooks';
import { Field } from './Fields';
import { declarations, entriesIn, groupsIn, nameOf, refusalOf, typedOf, valueOf, type SemanticEdit } from './semantic';
import { dataOf, semanticDraftsOf, type SemanticDraft, type SemanticDrafts } from './semantic_drafts';

type Change = (edit: SemanticEdit) => Promise<string | null>;

interface EntriesProps {
  entries: JsonMap;
  around: string[];
  fixed: boolean;
  change: Change;
}

function Remove({ keys, change }: { keys: string[]; change: Change }) {
  const [problem, setProblem] = useState<string | null>(null);
  return (
    <>
      <button type="button" className="small" aria-label={'Remove ' + nameOf(keys)} onClick={() => void change({ keys }).then(setProblem)}>remove</button>
      {problem && <output className="bad">{problem}</output>}
    </>
  );
}

function Entry({ keys, value, fixed, change }: { keys: string[]; value: Json; fixed: boolean; change: Change }) {
  const [key, around] = [keys[keys.length - 1] ?? '', keys.slice(0, -1)];
  const typed = typedOf(value);
  if (typed === null && isMap(value)) {
    return (
      <div role="group" aria-label={nameOf(keys)} className="entries">
        <p className="row"><strong>{key}</strong>{!fixed && <Remove keys={keys} change={change} />}</p>
        <Entries entries={value} around={keys} fixed={fixed} change={change} />
      </div>
    );
  }
  const set = async (text: string) => {
    try {
      return await change({ keys, value: valueOf(text, value) });
    } catch (error) {
      return reason(error);
    }
  };
  return (
    <div className="entry">
      <Field key={typed} label={key} name={nameOf(keys)} value={typed ?? ''} lines={typed?.includes('\n')} placeholder={isMap(value) ? 'no entries' : undefined} note={around.join() === 'segue' ? declarations[key] : undefined} fixed={fixed} onSet={set} />
      {!fixed && <Remove keys={keys} change={change} />}
    </div>
  );
}

function Entries({ entries, around, fixed, change }: EntriesProps) {
  return <>{entriesIn(entries).map(([key, value]) => <Entry key={key} keys={[...around, key]} value={value} fixed={fixed} change={change} />)}</>;
}

/** A new entry: a text, or one that gets entries of its own. */
function NewEntry({ data, change }: { data: JsonMap; change: Change }) {
  const [into, setInto] = useState(0);
  const [key, setKey] = useState('');
  const [value, setValue] = useState('');
  const [problem, setProblem] = useState<string | null>(null);
  const id = useId();
  const groups = groupsIn(data);
  const known = groups.some((group) => group.join() === 'segue') ? groups : [...groups, ['segue']];
  const around = known[into] ?? [];
  const keyless = key.trim() === '' ? 'needs a key' : '';
  const add = async (what: Json) => {
    const name = key.trim();
    const refused = refusalOf(data, around, name) ?? (await change({ keys: [...around, name], value: what }));
    setProblem(refused);
    if (refused === null) [setKey(''), setValue('')];
  };
  return (
    <form aria-label="New entry" className="new-entry" onSubmit={(event: FormEvent) => [event.preventDefault(), void add(value)]}>
      <h3>New entry</h3>
      <p className="row">
        <label htmlFor={id + '-into'}>in</label>
        <select id={id + '-into'} value={into} onChange={(event) => setInto(Number(event.target.value))}>
          {known.map((group, index) => <option key={nameOf(group)} value={index}>{group.length === 0 ? 'the state' : nameOf(group)}</option>)}
        </select>
      </p>
      <p className="row"><label htmlFor={id + '-key'}>key</label><input id={id + '-key'} value={key} list={id + '-keys'} spellCheck={false} onChange={(event) => setKey(event.target.value)} /></p>
      <datalist id={id + '-keys'}>{around.join() === 'segue' && Object.entries(declarations).map(([name, doc]) => <option key={name} value={name}>{doc}</option>)}</datalist>
      <p className="row"><label htmlFor={id + '-value'}>text</label><input id={id + '-value'} value={value} spellCheck={false} onChange={(event) => setValue(event.target.value)} /></p>
      {around.join() === 'segue' && declarations[key.trim()] && <p className="quiet">{declarations[key.trim()]}</p>}
      <p className="row">
        <ActionButton type="submit" whyNot={keyless}>Add the text</ActionButton>
        <ActionButton type="button" whyNot={keyless || (value !== '' ? 'a group has no text' : '')} title="An entry that gets entries of its own" onClick={() => void add({})}>Add a group</ActionButton>
      </p>
      {problem && <output className="bad" role="alert">{problem}</output>}
    </form>
  );
}

function Bar({ draft, drafts, onSaved }: { draft: SemanticDraft; drafts: SemanticDrafts; onSaved: () => void }) {
  const { path, state } = draft;
  const unsaved = draft.edits.length > 0;
  return (
    <p className="row">
      <ActionButton type="button" className="primary" tip whyNot={draft.saving ? 'is being saved' : unsaved ? '' : 'nothing is unsaved'} onClick={() => void drafts.save(path, state).then((done) => done && onSaved())}>Save semantic data</ActionButton>
      <ActionButton type="button" tip whyNot={unsaved ? '' : 'nothing to undo'} onClick={() => drafts.undo(path, state)}>Undo</ActionButton>
      <ActionButton type="button" tip whyNot={draft.undone.length > 0 ? '' : 'nothing to redo'} onClick={() => drafts.redo(path, state)}>Redo</ActionButton>
      <span className="quiet" aria-live="polite">{unsaved ? draft.edits.length + ' unsaved' : 'as in the file'}</span>
    </p>
  );
}

interface Props {
  /** The machine, and the folder of the state in it. */
  path: string;
  state: string;
  fixed: boolean;
  onSaved: () => void;
}

/** The semantic data of a state of RAFCON, which are saved to its file. */
export function SemanticData({ path, state, fixed, onSaved }: Props) {
  const drafts = semanticDraftsOf(useConnection());
  const draft = useSyncExternalStore(drafts.subscribe, () => drafts.get(path, state));
  useEffect(() => void drafts.open(path, state), [drafts, path, state]);
  if (!draft) return <p className="quiet">reading the semantic data …</p>;
  if (draft.error !== '' && draft.version === '' && draft.edits.length === 0) return <p className="bad" role="alert">{draft.error}</p>; // they could not be read
  const data = dataOf(draft);
  const change = (edit: SemanticEdit) => drafts.add(path, state, edit);
  return (
    <section className="semantic-data" aria-label="Semantic data">
      <h3>Semantic data</h3>
      {!fixed && <Bar draft={draft} drafts={drafts} onSaved={onSaved} />}
      {draft.error && (
        <p className="bad" role="alert">
          {draft.error} {draft.conflict && <button type="button" onClick={() => void drafts.readAgain(path, state)}>Read the file again</button>}
        </p>
      )}
      {Object.keys(data).length === 0 ? <p className="quiet">none</p> : <Entries entries={data} around={[]} fixed={fixed} change={change} />}
      {!fixed && <NewEntry data={data} change={change} />}
    </section>
  );
}
