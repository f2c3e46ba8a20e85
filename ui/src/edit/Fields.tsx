// SPDX-License-Identifier: Apache-2.0
import { useId, useState, type FormEvent, type KeyboardEvent } from 'react';
import { stringify } from 'yaml';
import { ActionButton } from '../ActionButton';

/** A value as it is typed and shown; nothing: ''. */
export const written = (value: unknown) => (value === undefined ? '' : stringify(value, { collectionStyle: 'flow', lineWidth: 0, flowCollectionPadding: false }).trimEnd());

export const portTypes = ['any', 'bool', 'int', 'float', 'text', 'list', 'map'];

/** The reason why a value is refused, or null; at once, or when it has been checked. */
export type Refusal = string | null | Promise<string | null>;

interface FieldProps {
  label: string;
  /** Where the label alone does not tell it from others. */
  name?: string;
  value: string;
  placeholder?: string;
  note?: string;
  fixed: boolean;
  /** It has several lines. */
  lines?: boolean;
  onSet: (value: string) => Refusal;
}

/** A value that is set by Enter, of several lines by its button; what is wrong with it stands below. */
export function Field({ label, name, value, placeholder, note, fixed, lines, onSet }: FieldProps) {
  const [typed, setTyped] = useState<string | null>(null);
  const [problem, setProblem] = useState<string | null>(null);
  const id = useId();
  const submit = async (event: FormEvent) => {
    event.preventDefault();
    if (typed === null) return;
    const refused = await onSet(typed);
    setProblem(refused);
    if (refused === null) setTyped(null);
  };
  const input = {
    id, placeholder, value: typed ?? value, readOnly: fixed, spellCheck: false, className: typed !== null ? 'edited' : '', 'aria-label': name, 'aria-describedby': note ? id + '-note' : undefined,
    onChange: (event: { target: { value: string } }) => setTyped(event.target.value),
    onKeyDown: (event: KeyboardEvent) => {
      if (event.key === 'Escape') [setTyped(null), setProblem(null)];
    },
  };
  return (
    <form className="row property" onSubmit={(event) => void submit(event)}>
      <label htmlFor={id}>{label}</label>
      {lines ? <textarea rows={Math.min(12, (typed ?? value).split('\n').length + 1)} {...input} /> : <input {...input} />}
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

/** A name (or `what`), and where wanted a type, of something new. */
export function Adding({ label, what = 'a name', withType, onAdd }: { label: string; what?: string; withType: boolean; onAdd: (name: string, type: string) => Refusal }) {
  const [name, setName] = useState('');
  const [type, setType] = useState('any');
  const [problem, setProblem] = useState<string | null>(null);
  const submit = async (event: FormEvent) => {
    event.preventDefault();
    const refused = await onAdd(name.trim(), type.trim() || 'any');
    setProblem(refused);
    if (refused === null) setName('');
  };
  return (
    <form
      className="row"
      onSubmit={(event) => void submit(event)}
    >
      <input aria-label={label} placeholder={label} value={name} spellCheck={false} onChange={(event) => setName(event.target.value)} />
      {withType && (
        <select aria-label={'Type of ' + label.toLowerCase()} value={type} onChange={(event) => setType(event.target.value)}>
          {portTypes.map((one) => <option key={one}>{one}</option>)}
        </select>
      )}
      <ActionButton type="submit" className="small" whyNot={name.trim() === '' ? 'needs ' + what : ''}>add</ActionButton>
      {problem && <output className="bad">{problem}</output>}
    </form>
  );
}
