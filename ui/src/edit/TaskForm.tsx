// SPDX-License-Identifier: Apache-2.0
import { useState, type FormEvent } from 'react';
import { PortName } from '../PortName';
import { portOf, taskOf } from '../robot/types';
import { Panel } from '../panes/Panel';
import { written } from './Fields';
import { partners, portsOf, type EditedPort, type Models, type PropertyModel } from './models';
import { NameField } from './NameField';
import type { NetworkText } from './text';

export interface Edits {
  setProperty: (task: string, name: string, yaml: string) => string | null;
  removeProperty: (task: string, name: string) => void;
  connect: (from: string, to: string) => void;
  disconnect: (index: number) => void;
  removeTask: (task: string) => void;
  /** Why not, or null. */
  renameTask: (task: string, name: string) => string | null;
}

function PropertyField({ task, model, value, edits, fixed }: { task: string; model: PropertyModel; value: unknown; edits: Edits; fixed: boolean }) {
  const [typed, setTyped] = useState<string | null>(null);
  const [problem, setProblem] = useState<string | null>(null);
  const submit = (event: FormEvent) => {
    event.preventDefault();
    if (typed === null) return;
    if (typed.trim() === '') edits.removeProperty(task, model.name);
    const refused = typed.trim() === '' ? null : edits.setProperty(task, model.name, typed);
    setProblem(refused);
    if (refused === null) setTyped(null);
  };
  const id = 'edit-' + task + '-' + model.name;
  return (
    <form className="row property" onSubmit={submit}>
      <label htmlFor={id}>{model.name}</label>
      <input
        id={id} value={typed ?? written(value)} placeholder={written(model.default)} readOnly={fixed} spellCheck={false}
        className={typed !== null ? 'edited' : ''} aria-describedby={id + '-doc'} onChange={(event) => setTyped(event.target.value)}
        onKeyDown={(event) => {
          if (event.key === 'Escape') [setTyped(null), setProblem(null)];
        }}
      />
      {typed !== null && <button type="submit">Set</button>}
      {typed === null && value !== undefined && !fixed && (
        <button type="button" className="small" aria-label={'Default of ' + model.name} onClick={() => edits.removeProperty(task, model.name)}>default</button>
      )}
      <small id={id + '-doc'} className="quiet">{[model.type, model.live ? 'can be set while it runs' : '', model.doc ?? ''].filter(Boolean).join('; ')}</small>
      {problem && <output className="bad">{problem}</output>}
    </form>
  );
}

function PortRow({ task, port, network, models, edits, fixed }: { task: string; port: EditedPort; network: NetworkText; models: Models; edits: Edits; fixed: boolean }) {
  const name = task + '.' + port.name;
  const output = port.direction === 'output';
  const others = fixed ? [] : partners(network, models, name, port.direction);
  return (
    <div className="port-row">
      <div><strong><PortName name={port.name} direction={port.direction} /></strong> <small className="quiet">{[port.type, port.doc].filter(Boolean).join('; ')}</small></div>
      <ul className="plain">
        {network.connections.map((one, index) =>
          one && (output ? one.from : one.to) === name ? (
            <li key={index} className="row">
              <span>{output ? 'to ' + one.to : 'from ' + one.from}</span>
              {!fixed && <button type="button" className="small" aria-label={'Remove ' + one.from + ' to ' + one.to} onClick={() => edits.disconnect(index)}>remove</button>}
            </li>
          ) : null,
        )}
      </ul>
      {others.length > 0 && (
        <select
          aria-label={'Connect ' + name} value=""
          onChange={(event) => (output ? edits.connect(name, event.target.value) : edits.connect(event.target.value, name))}
        >
          <option value="" disabled>connect {output ? 'to' : 'from'} …</option>
          {others.map((other) => <option key={other} value={other}>{taskOf(other)}.{portOf(other)}</option>)}
        </select>
      )}
    </div>
  );
}

/** A task of the network as it is edited: properties and connections, also by keyboard. */
export function TaskForm({ id, network, models, edits, fixed, onClose }: { id: string; network: NetworkText; models: Models; edits: Edits; fixed: boolean; onClose: () => void }) {
  const task = network.tasks.find((one) => one.id === id);
  if (!task) return null;
  const model = models.get(task.component);
  const known = model?.properties ?? [];
  const others = Object.keys(task.properties).filter((name) => !known.some((property) => property.name === name));
  const properties = [...known, ...others.map((name) => ({ name, type: '', doc: model ? 'not a property of this component' : '' }))];
  return (
    <Panel label={'Edit task ' + id}>
      <header>
        <h2>{id}</h2>
        <button type="button" aria-label="Close" onClick={onClose}>×</button>
      </header>
      <p>{task.component} {!model && <span className="badge warn">unknown component</span>}</p>
      {model?.doc && <p className="quiet">{model.doc}</p>}
      {!fixed && <NameField key={id} label="Name" name={id} onRename={(name) => edits.renameTask(id, name)} />}
      {properties.length > 0 && <h3>Properties</h3>}
      {properties.map((property) => (
        <PropertyField key={property.name} task={id} model={property} value={task.properties[property.name]} edits={edits} fixed={fixed} />
      ))}
      <h3>Ports</h3>
      {portsOf(network, models, id).map((port) => (
        <PortRow key={port.direction + port.name} task={id} port={port} network={network} models={models} edits={edits} fixed={fixed} />
      ))}
      {!fixed && <p className="doit"><button type="button" onClick={() => edits.removeTask(id)}>Remove task</button></p>}
    </Panel>
  );
}
