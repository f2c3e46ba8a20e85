// SPDX-License-Identifier: Apache-2.0
import { useState } from 'react';
import { Adding, Choice, Field, portTypes, written, type Refusal } from './Fields';
import { facts, flags, runEntries, usersOf, type Side } from './mission_actions';
import type { ActionText, MissionPort, MissionText } from './mission_text';
import { record, type Path } from './yaml_edit';

/** Each answers what is wrong, or null. */
export interface ActionEdits {
  /** Those of facts and resources are checked first. */
  setEntry: (path: Path, typed: string, kind: 'text' | 'yaml') => Refusal;
  addEntry: (key: string, typed: string, kind: 'text' | 'yaml') => Refusal;
  setFlag: (flag: string, on: boolean) => void;
  addPort: (side: Side, name: string, type: string) => string | null;
  setPort: (side: Side, port: MissionPort, type: string, yaml: string) => string | null;
  removePort: (side: Side, name: string) => void;
  addOutcome: (name: string) => string | null;
  removeOutcome: (name: string) => void;
}

interface Props {
  mission: MissionText;
  action: ActionText;
  fixed: boolean;
  edits: ActionEdits;
}

function Remove({ what, onRemove }: { what: string; onRemove: () => void }) {
  return <button type="button" className="small" aria-label={'Remove ' + what} onClick={onRemove}>remove</button>;
}

function Ports({ side, props }: { side: Side; props: Props }) {
  const { action, fixed, edits } = props;
  const name = side === 'inputs' ? 'input' : 'output';
  return (
    <>
      <h3>{side === 'inputs' ? 'Inputs' : 'Outputs'} of the action</h3>
      {action[side].map((port) => (
        <div key={port.name}>
          <Choice label={'type of ' + port.name} value={port.type} options={portTypes} fixed={fixed} onChoose={(type) => void edits.setPort(side, port, type, written(port.default))} />
          <Field label={'default of ' + port.name} value={written(port.default)} fixed={fixed} onSet={(yaml) => edits.setPort(side, port, port.type, yaml)} />
          {!fixed && <Remove what={name + ' ' + port.name + ' of the action'} onRemove={() => edits.removePort(side, port.name)} />}
        </div>
      ))}
      {!fixed && <Adding label={'New ' + name + ' of the action'} withType onAdd={(added, type) => edits.addPort(side, added, type)} />}
    </>
  );
}

function Outcomes({ props }: { props: Props }) {
  const { action, fixed, edits } = props;
  const expected = record(action.value['expect']);
  return (
    <>
      <h3>Outcomes of the action</h3>
      <ul className="plain">
        {action.outcomes.map((outcome) => (
          <li key={outcome} className="row">
            <span>{outcome}</span>
            {!fixed && action.outcomes.length > 1 && <Remove what={'outcome ' + outcome + ' of the action'} onRemove={() => edits.removeOutcome(outcome)} />}
          </li>
        ))}
      </ul>
      {!fixed && <Adding label="New outcome of the action" withType={false} onAdd={edits.addOutcome} />}
      <Field label="expected duration" value={written(expected['duration'])} placeholder="not known" fixed={fixed} note="such as 2s, 500ms" onSet={(typed) => edits.setEntry(['expect', 'duration'], typed, 'yaml')} />
      <Choice label="expected outcome" value={written(expected['outcome'])} options={action.outcomes} empty="not known" fixed={fixed} onChoose={(outcome) => void edits.setEntry(['expect', 'outcome'], outcome, 'text')} />
    </>
  );
}

interface ListProps {
  name: string;
  doc: string;
  kind: 'text' | 'yaml';
  /** The list as it is written; anything else: none. */
  value: unknown;
  fixed: boolean;
  edits: Pick<ActionEdits, 'setEntry' | 'addEntry'>;
}

/** Facts or resources of an action or container. */
export function List({ name, doc, kind, value, fixed, edits }: ListProps) {
  const entries: unknown[] = Array.isArray(value) ? value : [];
  if (fixed && entries.length === 0) return null;
  return (
    <>
      <h3>{name}</h3>
      <p className="quiet">{doc}</p>
      {entries.map((entry, index) => (
        <Field
          key={index + written(entry)} label={name + ' ' + (index + 1)} value={typeof entry === 'string' ? entry : written(entry)} fixed={fixed} note={fixed ? undefined : 'empty: it is removed'}
          onSet={(typed) => edits.setEntry([name, index], typed, kind)}
        />
      ))}
      {!fixed && <Adding label={'New entry of ' + name} what="an entry" withType={false} onAdd={(typed) => edits.addEntry(name, typed, kind)} />}
    </>
  );
}

/** The declaration of an action in the mission and the way it runs, the same for all states that use it. */
export function ActionForm(props: Props) {
  const { mission, action, fixed, edits } = props;
  const [open, setOpen] = useState(false);
  const others = usersOf(mission, action).length - 1;
  return (
    <section className="action-form" aria-label={'Action ' + action.name}>
      <button type="button" className="line" aria-expanded={open} onClick={() => setOpen(!open)}>
        <span>Action {action.name}</span>
        <span className="quiet">{others > 0 ? 'of ' + (others + 1) + ' states' : ''}</span>
      </button>
      {open && (
        <>
          {others > 0 && <p className="note">{others + 1} states stand for it: what is changed here changes for all of them.</p>}
          <Field label="action's description" value={action.description} fixed={fixed} onSet={(typed) => edits.setEntry(['description'], typed, 'text')} />
          <Ports side="inputs" props={props} />
          <Ports side="outputs" props={props} />
          <Outcomes props={props} />
          <h3>What it runs</h3>
          {runEntries(action).map((entry) => (
            <Field key={entry.label} label={entry.label} value={written(entry.value)} fixed={fixed} onSet={(typed) => edits.setEntry(entry.path, typed, 'yaml')} />
          ))}
          {facts.map(({ key, doc }) => <List key={key} name={key} doc={doc} kind="text" value={action.value[key]} fixed={fixed} edits={edits} />)}
          <List name="resources" doc="such as {block: arm} or {consume: cup, count: 2}" kind="yaml" value={action.value['resources']} fixed={fixed} edits={edits} />
          <h3>In concurrent runs</h3>
          {flags.map(({ key, doc }) => (
            <label key={key} className="flag">
              <input type="checkbox" checked={action.value[key] === true} disabled={fixed} onChange={(event) => edits.setFlag(key, event.target.checked)} /> {key} <small className="quiet">{doc}</small>
            </label>
          ))}
        </>
      )}
    </section>
  );
}
