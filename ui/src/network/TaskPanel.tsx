// SPDX-License-Identifier: Apache-2.0
import { createContext, useContext, useState, type FormEvent, type ReactNode } from 'react';
import { addressOf } from '../address';
import { Name } from '../Name';
import { PortName } from '../PortName';
import { reason } from '../reason';
import { isMap, type Json } from '../robot/change';
import { howLong, troubleOfTask } from '../health/health';
import { useConnection, useDocument } from '../robot/hooks';
import { Skipped } from '../robot/Skipped';
import type { OperationModel, PortModel, Status, TaskReport } from '../robot/types';
import { nodeOfTask } from '../ros2/ros2';
import { Panel } from '../panes/Panel';
import { Connections } from './Connections';
import { toneOf, type Flows } from './graph';
import { Plot } from './Plot';
import { TaskLog } from './TaskLog';
import { Timing } from './Timing';

/** Whether what is set, written and called is meant beside what a mission is doing. */
const BesideMission = createContext(false);

/** One property: its value as text, which is sent on Enter. What the robot says in between wins unless it is edited. */
function Property({ task, name, value, fixed }: { task: string; name: string; value: Json; fixed: boolean }) {
  const connection = useConnection();
  const beside = useContext(BesideMission);
  const [edited, setEdited] = useState<string | null>(null);
  const [note, setNote] = useState<{ text: string; bad: boolean } | null>(null);
  const shown = typeof value === 'string' ? value : JSON.stringify(value);
  const submit = async (event: FormEvent) => {
    event.preventDefault();
    if (edited === null) return;
    try {
      await connection.call('set', { task, property: name, yaml: edited, beside_mission: beside });
      setEdited(null);
      setNote({ text: 'set', bad: false });
    } catch (error) {
      setNote({ text: reason(error), bad: true });
    }
  };
  return (
    <form className="row" onSubmit={(event) => void submit(event)}>
      <label htmlFor={'property-' + name}>{name}</label>
      <input
        id={'property-' + name}
        value={edited ?? shown}
        readOnly={fixed}
        spellCheck={false}
        className={edited !== null && edited !== shown ? 'edited' : ''}
        onChange={(event) => {
          setEdited(event.target.value);
          setNote(null);
        }}
        onKeyDown={(event) => {
          if (event.key !== 'Escape' || edited === null) return;
          event.stopPropagation();
          setEdited(null);
        }}
      />
      {edited !== null && <button type="submit">Set</button>}
      {note && <output className={note.bad ? 'bad' : 'good'}>{note.text}</output>}
    </form>
  );
}

function PortSamples({ task, port }: { task: string; port: PortModel }) {
  const shown = useDocument('port/' + task + '/' + port.name);
  const [frozen, setFrozen] = useState<Json | null>(null);
  if (shown?.error) return <p className="bad">{shown.error}</p>;
  if (!isMap(shown?.value)) return <p className="quiet">no sample yet</p>;
  const sample = shown.value['value'] ?? null;
  const kept = frozen ?? sample;
  return (
    <div className="samples">
      <Plot label={task + '.' + port.name} time={Number(shown.value['time_s'])} value={sample} frozen={frozen !== null} />
      <pre tabIndex={0}>{JSON.stringify(kept, null, 1).slice(0, 4000)}</pre>
      <button type="button" aria-pressed={frozen !== null} onClick={() => setFrozen(frozen === null ? sample : null)}>
        {frozen === null ? 'Freeze' : 'Go on'}
      </button>
      <Skipped count={shown.skipped} />
    </div>
  );
}

function WriteSample({ task, port }: { task: string; port: PortModel }) {
  const connection = useConnection();
  const beside = useContext(BesideMission);
  const [text, setText] = useState('');
  const [note, setNote] = useState<{ text: string; bad: boolean } | null>(null);
  const submit = async (event: FormEvent) => {
    event.preventDefault();
    try {
      await connection.call('write', { task, port: port.name, yaml: text, beside_mission: beside });
      setNote({ text: 'written', bad: false });
    } catch (error) {
      setNote({ text: reason(error), bad: true });
    }
  };
  return (
    <form className="row" onSubmit={(event) => void submit(event)}>
      <label htmlFor={'write-' + port.name}>sample</label>
      <input id={'write-' + port.name} value={text} placeholder={port.type} onChange={(event) => setText(event.target.value)} />
      <button type="submit">Write</button>
      {note && <output className={note.bad ? 'bad' : 'good'}>{note.text}</output>}
    </form>
  );
}

function Port({ task, port, fixed }: { task: string; port: PortModel; fixed: boolean }) {
  const [open, setOpen] = useState(false);
  const input = port.direction === 'input';
  return (
    <li>
      <button type="button" className="line" aria-expanded={open} onClick={() => setOpen(!open)} title={port.doc}>
        <PortName name={port.name} direction={port.direction} />
        <span className="quiet">{port.type}</span>
      </button>
      {open && !input && <PortSamples task={task} port={port} />}
      {open && input && (fixed ? <p className="quiet">Who observes cannot write.</p> : <WriteSample task={task} port={port} />)}
    </li>
  );
}

function Operation({ task, operation, fixed }: { task: string; operation: OperationModel; fixed: boolean }) {
  const connection = useConnection();
  const beside = useContext(BesideMission);
  const [texts, setTexts] = useState<string[]>(operation.arguments.map(() => ''));
  const [note, setNote] = useState<{ text: string; bad: boolean } | null>(null);
  const submit = async (event: FormEvent) => {
    event.preventDefault();
    setNote(null);
    try {
      // Each argument is YAML in itself; the server reads the list of them.
      const yaml = '[' + texts.join('\n, ') + '\n]';
      const result = await connection.call('call', { task, operation: operation.name, yaml, beside_mission: beside });
      setNote({ text: result === null ? 'done' : JSON.stringify(result), bad: false });
    } catch (error) {
      setNote({ text: reason(error), bad: true });
    }
  };
  return (
    <form className="operation" onSubmit={(event) => void submit(event)} title={operation.doc}>
      <div className="row">
        <strong>{operation.name}</strong>
        {!fixed && <button type="submit" aria-label={'Call ' + operation.name}>Call</button>}
        {note && <output className={note.bad ? 'bad' : 'good'}>{note.text}</output>}
      </div>
      {operation.arguments.map((argument, index) => (
        <div className="row" key={argument.name}>
          <label htmlFor={'argument-' + operation.name + '-' + argument.name}>{argument.name}</label>
          <input
            id={'argument-' + operation.name + '-' + argument.name}
            placeholder={argument.type}
            value={texts[index]}
            onChange={(event) => setTexts(texts.map((text, at) => (at === index ? event.target.value : text)))}
          />
        </div>
      ))}
    </form>
  );
}

/** The component and the state of the task. */
function Summary({ id, status }: { id: string; status: Status }) {
  const task = status.tasks[id];
  const trouble = troubleOfTask(status, id);
  return (
    <>
      {task && (
        <p>
          <span className={'badge tone-' + toneOf(task.state)}>{task.state_name || task.state}</span>{' '}
          <span className="quiet">{task.component}, process {task.pid}</span>
        </p>
      )}
      {task?.error && <p className="bad">{task.error}</p>}
      {trouble && <p className="bad">{trouble.what}, since {howLong(trouble.for_s)}: {trouble.repair}</p>}
    </>
  );
}

/** Where the node of a task of ROS 2 is shown. */
function NodeLink({ report }: { report: TaskReport }) {
  const node = nodeOfTask(report.id, report.component, report.properties);
  return node === null ? null : <p>node of ROS 2: <a href={addressOf('ros2', node)}><Name text={node} /></a></p>;
}

/** The ports, properties and operations of the task, with the means to use them. */
function Interior({ id, report, fixed, children }: { id: string; report: TaskReport; fixed: boolean; children: ReactNode }) {
  const properties = Object.entries(report.properties);
  return (
    <>
      <NodeLink report={report} />
      {report.doc && <p>{report.doc}</p>}
      <h3>Properties</h3>
      {properties.length === 0 && <p className="quiet">none</p>}
      {properties.map(([name, value]) => <Property key={name} task={id} name={name} value={value} fixed={fixed} />)}
      <h3>Ports</h3>
      <ul className="plain">
        {report.ports.map((port) => <Port key={port.name} task={id} port={port} fixed={fixed} />)}
      </ul>
      {children}
      <h3>Operations</h3>
      {report.operations.length === 0 && <p className="quiet">none</p>}
      {fixed && report.operations.length > 0 && <p className="quiet">Who observes cannot call.</p>}
      {report.operations.map((operation) => <Operation key={operation.name} task={id} operation={operation} fixed={fixed} />)}
      <Timing report={report} />
      <TaskLog report={report} />
    </>
  );
}

export function TaskPanel({ id, status, flows, onClose }: { id: string; status: Status; flows: Flows; onClose: () => void }) {
  const connection = useConnection();
  const shown = useDocument('task/' + id);
  const [beside, setBeside] = useState(false);
  const fixed = !connection.mayOperate;
  const report = isMap(shown?.value) ? (shown.value as unknown as TaskReport) : null;
  return (
    <Panel label={'Task ' + id}>
      <header>
        <h2>{id}</h2>
        <button type="button" onClick={onClose} aria-label="Close (Escape)">×</button>
      </header>
      {shown?.error && <p className="bad">{shown.error}</p>}
      <Summary id={id} status={status} />
      {report && (
        <BesideMission.Provider value={beside}>
          {status.commanded_by && !fixed && (
            <label>
              <input type="checkbox" checked={beside} onChange={(event) => setBeside(event.target.checked)} /> beside what {status.commanded_by} is doing
            </label>
          )}
          <Interior id={id} report={report} fixed={fixed}>
            <Connections id={id} status={status} flows={flows} />
          </Interior>
        </BesideMission.Provider>
      )}
    </Panel>
  );
}
