// SPDX-License-Identifier: Apache-2.0
import type { ReactNode } from 'react';
import { ActionButton } from '../ActionButton';
import { Panel } from '../panes/Panel';
import { ActionForm, List, type ActionEdits } from './ActionForm';
import { Adding, Choice, Field, written } from './Fields';
import { flowPartners } from './mission_graph';
import { extraOutcomes, interfaceIn, isContainer, outcomesIn, targetsOf, type EditedState, type Interface, type MissionPort, type MissionText } from './mission_text';
import { NameField } from './NameField';
import { record } from './yaml_edit';

type Side = 'inputs' | 'outputs';
type Ports = Side | 'variables';

/** Each answers what is wrong, or null. */
export interface StateEdits extends Pick<ActionEdits, 'setEntry' | 'addEntry'> {
  rename: (name: string) => string | null;
  remove: () => void;
  move: (container: EditedState, before: string | null) => void;
  setTransition: (outcome: string, target: string | null) => void;
  setStart: (target: string) => void;
  setValue: (side: Side, port: string, yaml: string) => string | null;
  setText: (key: 'title' | 'description', value: string) => string | null;
  setKind: (kind: string) => void;
  setUse: (name: string) => void;
  addOutcome: (name: string) => string | null;
  removeOutcome: (name: string) => void;
  addPort: (which: Ports, name: string, type: string) => string | null;
  removePort: (which: Ports, name: string) => void;
  setDefault: (which: Ports, port: MissionPort, yaml: string) => string | null;
  connect: (container: EditedState, from: string, to: string) => void;
  disconnect: (container: EditedState, index: number) => void;
  addAction: (name: string) => string | null;
  ofAction: (name: string) => ActionEdits;
}

interface Props {
  mission: MissionText;
  libraries: Interface[];
  state: EditedState;
  containers: EditedState[];
  fixed: boolean;
  edits: StateEdits;
}

/** The data flows of one port, and those that could be. */
function Flows({ container, port, side, props }: { container: EditedState; port: string; side: 'from' | 'to'; props: Props }) {
  const { mission, libraries, fixed, edits } = props;
  const others = fixed ? [] : flowPartners(mission, libraries, container, port, side);
  return (
    <div className="port-row">
      <ul className="plain">
        {container.flows.map((flow, index) =>
          flow && flow[side] === port ? (
            <li key={index} className="row">
              <span>{side === 'from' ? port + ' goes to ' + flow.to : port + ' comes from ' + flow.from}</span>
              {!fixed && <button type="button" className="small" aria-label={'Remove ' + flow.from + ' to ' + flow.to} onClick={() => edits.disconnect(container, index)}>remove</button>}
            </li>
          ) : null,
        )}
      </ul>
      {others.length > 0 && (
        <select aria-label={'Connect ' + port} value="" onChange={(event) => (side === 'from' ? edits.connect(container, port, event.target.value) : edits.connect(container, event.target.value, port))}>
          <option value="" disabled>connect {port} {side === 'from' ? 'to' : 'from'} …</option>
          {others.map((other) => <option key={other} value={other}>{other}</option>)}
        </select>
      )}
    </div>
  );
}

function Transitions({ props }: { props: Props }) {
  const { mission, libraries, state, fixed, edits } = props;
  const known = outcomesIn(mission, libraries, state);
  const targets = targetsOf(state);
  return (
    <>
      <h3>Transitions</h3>
      {[...known, ...extraOutcomes.filter((one) => !known.includes(one))].map((outcome) => (
        <Choice
          key={outcome} label={'on ' + outcome} value={state.on.find((one) => one.outcome === outcome)?.target ?? ''} options={targets} empty={extraOutcomes.includes(outcome) ? 'as the container' : 'none yet'}
          fixed={fixed} onChoose={(target) => edits.setTransition(outcome, target === '' ? null : target)}
        />
      ))}
    </>
  );
}

/** Ports of an action or library: values in place of their defaults. */
function Values({ side, props }: { side: Side; props: Props }) {
  const { mission, libraries, state, fixed, edits } = props;
  const ports = interfaceIn(mission, libraries, state)?.[side] ?? [];
  const others = Object.keys(state.values[side]).filter((name) => !ports.some((port) => port.name === name));
  const all: MissionPort[] = [...ports, ...others.map((name) => ({ name, type: '' }))];
  const container = state.parent;
  if (all.length === 0) return null;
  return (
    <>
      <h3>{side === 'inputs' ? 'Inputs' : 'Outputs'}</h3>
      {all.map((port) => (
        <div key={port.name}>
          <Field
            label={port.name} value={written(state.values[side][port.name])} placeholder={written(port.default)} fixed={fixed} note={[port.type || 'not a port of what it stands for', port.default !== undefined ? 'default ' + written(port.default) : ''].filter(Boolean).join('; ')}
            onSet={(yaml) => edits.setValue(side, port.name, yaml)}
          />
          {container && <Flows container={container} port={state.name + '.' + port.name} side={side === 'inputs' ? 'to' : 'from'} props={props} />}
        </div>
      ))}
    </>
  );
}

function OwnPorts({ which, props }: { which: Ports; props: Props }) {
  const { state, fixed, edits } = props;
  const name = which === 'inputs' ? 'Input' : which === 'outputs' ? 'Output' : 'Variable';
  return (
    <>
      <h3>{name}s</h3>
      {state[which].map((port) => (
        <div key={port.name}>
          <Field label={port.name} value={written(port.default)} fixed={fixed} note={port.type + ', default'} onSet={(yaml) => edits.setDefault(which, port, yaml)} />
          {!fixed && <button type="button" className="small" aria-label={'Remove ' + name.toLowerCase() + ' ' + port.name} onClick={() => edits.removePort(which, port.name)}>remove</button>}
          {which !== 'outputs' && <Flows container={state} port={which + '.' + port.name} side="from" props={props} />}
          {which !== 'inputs' && <Flows container={state} port={which + '.' + port.name} side="to" props={props} />}
          {state.parent && which !== 'variables' && <Flows container={state.parent} port={state.name + '.' + port.name} side={which === 'inputs' ? 'to' : 'from'} props={props} />}
        </div>
      ))}
      {!fixed && <Adding label={'New ' + name.toLowerCase()} withType onAdd={(added, type) => edits.addPort(which, added, type)} />}
    </>
  );
}

function Container({ props }: { props: Props }) {
  const { state, fixed, edits } = props;
  const returns = [...state.outcomes, ...extraOutcomes].map((outcome) => 'return ' + outcome);
  return (
    <>
      <Choice label="Kind" value={state.kind} options={['hierarchy', 'barrier', 'preemptive']} fixed={fixed} onChoose={edits.setKind} />
      {state.kind === 'hierarchy' && <Choice label="Start" value={state.start} options={[...state.children.map((one) => one.name), ...returns]} fixed={fixed} onChoose={edits.setStart} />}
      <h3>Outcomes</h3>
      <ul className="plain">
        {state.outcomes.map((outcome) => (
          <li key={outcome} className="row">
            <span>{outcome}</span>
            {!fixed && state.outcomes.length > 1 && <button type="button" className="small" aria-label={'Remove outcome ' + outcome} onClick={() => edits.removeOutcome(outcome)}>remove</button>}
          </li>
        ))}
      </ul>
      {!fixed && <Adding label="New outcome" withType={false} onAdd={edits.addOutcome} />}
      <OwnPorts which="inputs" props={props} />
      <OwnPorts which="outputs" props={props} />
      <OwnPorts which="variables" props={props} />
      <Declared props={props} />
    </>
  );
}

/** The needs of a container; the facts and resources of the mission. A library has neither. */
function Declared({ props: { state, fixed, edits } }: { props: Props }) {
  const { declares, path } = state;
  const list = { fixed, edits };
  if (state.parent) {
    return (
      <>
        <List name="preconditions" doc="such as !held({box}), with its inputs; checked when it and each action in it begins" kind="text" value={declares['preconditions']} {...list} />
        <List name="resources" doc="such as {block: arm}: held from its begin to its end" kind="yaml" value={declares['resources']} {...list} />
      </>
    );
  }
  if (path.length > 0) return null;
  const resources = Object.entries(record(declares['resources']));
  return (
    <>
      <List name="world" doc="facts that hold at first, such as at(robot, dock)" kind="text" value={declares['world']} {...list} />
      {(!fixed || resources.length > 0) && <h3>Resources of the mission</h3>}
      {resources.map(([name, value]) => (
        <Field key={name + written(value)} label={'resource ' + name} value={written(value)} fixed={fixed} note={fixed ? undefined : 'such as {count: 2}; empty: it is removed'} onSet={(typed) => edits.setEntry(['resources', name], typed, 'yaml')} />
      ))}
      {!fixed && <Adding label="New resource of the mission" withType={false} onAdd={(name) => (resources.some(([one]) => one === name) ? 'there is a resource ' + name + ' already' : edits.setEntry(['resources', name], '{count: 1}', 'yaml'))} />}
    </>
  );
}

function Place({ props }: { props: Props }) {
  const { state, containers, edits } = props;
  const around = state.parent;
  if (!around) return null;
  const at = around.children.indexOf(state);
  const name = (container: EditedState) => container.id || 'the mission';
  const others = containers.filter((one) => one !== around && one !== state && !(one.id + '/').startsWith(state.id + '/') && !one.children.some((child) => child.name === state.name));
  return (
    <>
      <h3>Place</h3>
      <p className="row">
        <ActionButton type="button" whyNot={at > 0 ? '' : 'it is the first'} onClick={() => edits.move(around, around.children[at - 1]?.name ?? null)}>Earlier</ActionButton>
        <ActionButton type="button" whyNot={at < around.children.length - 1 ? '' : 'it is the last'} onClick={() => edits.move(around, around.children[at + 2]?.name ?? null)}>Later</ActionButton>
      </p>
      {others.length > 0 && (
        <select aria-label="Move into" value="" onChange={(event) => edits.move(others[Number(event.target.value)] ?? around, null)}>
          <option value="" disabled>move into …</option>
          {others.map((container, index) => <option key={container.id} value={index}>{name(container)}</option>)}
        </select>
      )}
    </>
  );
}

/** The action or library that a leaf or library state uses. */
function Use({ props }: { props: Props }) {
  const { mission, libraries, state, fixed, edits } = props;
  if (state.kind === 'library') return <Choice label="Library" value={state.library} options={libraries.map((one) => one.name)} fixed={fixed} onChoose={edits.setUse} />;
  return (
    <>
      <Choice label="Action" value={state.action} options={mission.actions.map((one) => one.name)} fixed={fixed} onChoose={edits.setUse} />
      {!fixed && <Adding label="New action" withType={false} onAdd={edits.addAction} />}
      <Choice label="Kind" value={state.kind} options={['execution', 'decider']} fixed={fixed} onChoose={edits.setKind} />
    </>
  );
}

/** A state of a mission as it is edited, all by keyboard. */
export function StateForm(props: Props & { onClose: () => void; isOpen: boolean; onToggle: () => void; children: ReactNode }) {
  const { mission, libraries, state, fixed, edits, onClose, isOpen, onToggle, children } = props;
  const known = interfaceIn(mission, libraries, state);
  const action = isContainer(state) || state.kind === 'library' ? undefined : mission.actions.find((one) => one.name === state.action);
  const label = state.id === '' ? 'mission' : 'state ' + state.id;
  const what = isContainer(state) ? state.kind : state.kind === 'library' ? 'library ' + state.library : (state.kind === 'decider' ? 'decider, action ' : 'action ') + state.action;
  return (
    <Panel label={'Edit ' + label}>
      <header>
        <h2>{state.id === '' ? state.name : state.id}</h2>
        <button type="button" aria-label="Close" onClick={onClose}>×</button>
      </header>
      <p>{what} {!known && <span className="badge warn">not known</span>}</p>
      {!isContainer(state) && known?.description && <p className="quiet">{known.description}</p>}
      {isContainer(state) && state.id !== '' && <p><button type="button" className="small" onClick={onToggle}>{isOpen ? 'Close in the graph' : 'Open in the graph'}</button></p>}
      {children}
      {state.parent && !fixed && <NameField key={state.id} label="Name" name={state.name} onRename={edits.rename} />}
      <Field key={'title ' + state.id} label="Title" value={state.title} fixed={fixed} onSet={(value) => edits.setText('title', value)} />
      <Field key={'description ' + state.id} label="Description" value={state.description} fixed={fixed} onSet={(value) => edits.setText('description', value)} />
      {!isContainer(state) && <Use props={props} />}
      {action && <ActionForm key={action.name} mission={mission} action={action} fixed={fixed} edits={edits.ofAction(action.name)} />}
      {state.parent && <Transitions props={props} />}
      {isContainer(state) ? <Container props={props} /> : <><Values side="inputs" props={props} /><Values side="outputs" props={props} /></>}
      {!fixed && <Place props={props} />}
      {state.parent && !fixed && <p className="doit"><button type="button" onClick={edits.remove}>Remove state</button></p>}
    </Panel>
  );
}
