// SPDX-License-Identifier: Apache-2.0
import { useId, useState, type FormEvent } from 'react';
import { stringify } from 'yaml';

/** A value as it is typed and shown; nothing: ''. */
export const written = (value: unknown) => (value === undefined ? '' : stringify(value, { collectionStyle: 'flow', lineWidth: 0, flowCollectionPadding: false }).trimEnd());

export const portTypes = ['any', 'bool', 'int', 'float', 'text', 'list', 'map'];

/** A value that is set by Enter; what is wrong with it stands below. */
export function Field({ label, value, placeholder, note, fixed, onSet }: { label: string; value: string; placeholder?: string; note?: string; fixed: boolean; onSet: (value: string) => string | null }) {
  const [typed, setTyped] = useState<string | null>(null);
  const [problem, setProblem] = useState<string | null>(null);
  const id = useId();
  const submit = (event: FormEvent) => {
    event.preventDefault();
    if (typed === null) return;
    const refused = onSet(typed);
    setProblem(refused);
    if (refused === null) setTyped(null);
  };
  return (
    <form className="row property" onSubmit={submit}>
      <label htmlFor={id}>{label}</label>
      <input
        id={id} value={typed ?? value} placeholder={placeholder} readOnly={fixed} spellCheck={false} className={typed !== null ? 'edited' : ''} aria-describedby={note ? id + '-note' : undefined}
        onChange={(event) => setTyped(event.target.value)}
        onKeyDown={(event) => {
          if (event.key === 'Escape') [setTyped(null), setProblem(null)];
        }}
      />
      {typed !== null && <button type="submit">Set</button>}
      {note && <small id={id + '-note'} className="quiet">{note}</small>}
      {problem && <output className="bad">{problem}</output>}
    </form>
  );
}

/** One of some names. */
export function Choice({ label, value, options, empty, fixed, onChoose }: { label: string; value: string; options: string[]; empty?: string; fixed: boolean; onChoose: (value: string) => void }) {
  const id = useId();
  const all = value === '' || options.includes(value) ? options : [value, ...options];
  return (
    <div className="row property">
      <label htmlFor={id}>{label}</label>
      <select id={id} value={value} disabled={fixed} onChange={(event) => onChoose(event.target.value)}>
        {(empty !== undefined || value === '') && <option value="">{empty ?? ''}</option>}
        {all.map((option) => <option key={option} value={option}>{option}</option>)}
      </select>
    </div>
  );
}

/** A name, and where wanted a type, of something new. */
export function Adding({ label, withType, onAdd }: { label: string; withType: boolean; onAdd: (name: string, type: string) => string | null }) {
  const [name, setName] = useState('');
  const [type, setType] = useState('any');
  const [problem, setProblem] = useState<string | null>(null);
  return (
    <form
      className="row"
      onSubmit={(event) => {
        event.preventDefault();
        const refused = onAdd(name.trim(), type.trim() || 'any');
        setProblem(refused);
        if (refused === null) setName('');
      }}
    >
      <input aria-label={label} placeholder={label} value={name} spellCheck={false} onChange={(event) => setName(event.target.value)} />
      {withType && (
        <select aria-label={'Type of ' + label.toLowerCase()} value={type} onChange={(event) => setType(event.target.value)}>
          {portTypes.map((one) => <option key={one}>{one}</option>)}
        </select>
      )}
      <button type="submit" className="small" disabled={name.trim() === ''}>add</button>
      {problem && <output className="bad">{problem}</output>}
    </form>
  );
}
