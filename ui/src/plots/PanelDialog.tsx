// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState, type FormEvent } from 'react';
import { ActionButton } from '../ActionButton';
import { isMap } from '../robot/change';
import { useDocument } from '../robot/hooks';
import type { Status } from '../robot/types';
import { fieldsOf, fits, kindNames, pathText, suggestedKind, type Field, type PanelKind } from './fields';
import { mostSources, sourceText, type Panel, type Source } from './layout';
import { portsWith, usePorts, type PortOfTask } from './usePorts';

const mostPortsListed = 200;
const kinds = Object.keys(kindNames) as PanelKind[];
const shapeNames: Record<Field['shape'], string> = {
  number: 'number', numbers: 'list of numbers', pose: 'pose', path: 'path', scan: 'laser scan', grid: 'occupancy grid', image: 'image',
};

/** The chosen source, with the field that it was when it was chosen; unknown in a panel that is edited. */
interface Choice {
  source: Source;
  field: Field | null;
}

/** The first kind that fits the first choice; the others show what fits it. */
function suggestionFor(choices: Choice[]): PanelKind | null {
  const field = choices.find((choice) => choice.field)?.field;
  return field ? suggestedKind(field) : null;
}

function FieldList({ port, chosen, onToggle }: { port: PortOfTask; chosen: Choice[]; onToggle: (choice: Choice) => void }) {
  const shown = useDocument('port/' + port.task + '/' + port.port);
  if (shown?.error) return <p className="bad">{shown.error}</p>;
  if (!isMap(shown?.value)) return <p className="quiet">Waiting for a sample: its fields are known then …</p>;
  const fields = fieldsOf(shown.value['value'] ?? null);
  if (fields.length === 0) return <p className="quiet">This sample has nothing that a panel can show.</p>;
  return (
    <ul className="plain">
      {fields.map((field) => {
        const source = { task: port.task, port: port.port, path: field.path };
        const text = sourceText(source);
        return (
          <li key={text}>
            <label className="line">
              <span>
                <input type="checkbox" checked={chosen.some((one) => sourceText(one.source) === text)} onChange={() => onToggle({ source, field })} />{' '}
                {pathText(field.path) || 'the whole sample'}
              </span>{' '}
              <span className="quiet">{shapeNames[field.shape]}{field.shape === 'numbers' ? ', ' + field.size : ''}</span>
            </label>
          </li>
        );
      })}
    </ul>
  );
}

interface PortListProps {
  status: Status;
  port: PortOfTask | null;
  onPort: (port: PortOfTask | null) => void;
}

function PortList({ status, port, onPort }: PortListProps) {
  const { ports, left } = usePorts(status);
  const [words, setWords] = useState('');
  const found = portsWith(ports, words);
  return (
    <section aria-label="Ports">
      <input
        type="search"
        aria-label="Find ports"
        placeholder="Find ports: task, port or type"
        value={words}
        onChange={(event) => setWords(event.target.value)}
        onKeyDown={(event) => {
          if (event.key !== 'Enter') return;
          event.preventDefault();
          onPort(found[0] ?? port);
        }}
      />
      <p className="quiet" role="status">
        {found.length} of {ports.length} output ports{left > 0 && ', asking ' + left + ' more tasks …'}
      </p>
      <ul className="plain list">
        {found.slice(0, mostPortsListed).map((one) => (
          <li key={one.task + '.' + one.port}>
            <button type="button" className="line" title={one.doc} aria-pressed={one === port} onClick={() => onPort(one)}>
              <span>{one.task}.{one.port}</span>
              <span className="quiet">{one.type}</span>
            </button>
          </li>
        ))}
        {found.length > mostPortsListed && <li className="quiet">and {found.length - mostPortsListed} more; search for them</li>}
      </ul>
    </section>
  );
}

/** The fields that are chosen, and what kind of panel shows which of them. */
function useChoices(panel: Panel | null) {
  const [choices, setChoices] = useState<Choice[]>(() => (panel?.sources ?? []).map((source) => ({ source, field: null })));
  const [asked, setAsked] = useState<PanelKind | null>(panel?.kind ?? null);
  const suggested = suggestionFor(choices);
  const kind = asked ?? suggested ?? 'time';
  const fitting = choices.filter((choice) => !choice.field || fits(kind, choice.field.shape)).slice(0, kind === 'image' ? 1 : mostSources);
  const toggle = (choice: Choice) => {
    const text = sourceText(choice.source);
    const others = choices.filter((one) => sourceText(one.source) !== text);
    setChoices(others.length < choices.length ? others : [...choices, choice]);
  };
  return { choices, fitting, kind, suggested, setAsked, toggle };
}
type Choices = ReturnType<typeof useChoices>;

function ChosenFields({ choices, fitting, kind, toggle }: Choices) {
  const misfits = choices.filter((choice) => !fitting.includes(choice));
  return (
    <>
      {choices.length > 0 && (
        <ul className="plain row" aria-label="Chosen fields">
          {choices.map((choice) => (
            <li key={sourceText(choice.source)}>
              <button type="button" className={'small' + (misfits.includes(choice) ? ' bad' : '')} aria-label={'Remove ' + sourceText(choice.source)} onClick={() => toggle(choice)}>
                {sourceText(choice.source)} ×
              </button>
            </li>
          ))}
        </ul>
      )}
      {misfits.length > 0 && <p className="bad">A {kindNames[kind]} cannot show {misfits.map((choice) => sourceText(choice.source)).join(', ')}.</p>}
    </>
  );
}

function KindChoice({ kind, suggested, setAsked }: Choices) {
  return (
    <fieldset className="row">
      <legend className="hidden">Kind of panel</legend>
      {kinds.map((one) => (
        <label key={one}>
          <input type="radio" name="kind" checked={kind === one} onChange={() => setAsked(one)} /> {kindNames[one]}
          {suggested === one && <span className="badge">fits</span>}
        </label>
      ))}
    </fieldset>
  );
}

/** The kind, title and sources of a panel, as chosen. */
export interface Chosen {
  kind: PanelKind;
  title: string;
  sources: Source[];
}

interface Props {
  status: Status;
  panel: Panel | null;
  onDone: (chosen: Chosen) => void;
  onClose: () => void;
}

/** Chooses what a new panel shows, or, with `panel`, what that one shows. */
export function PanelDialog({ status, panel, onDone, onClose }: Props) {
  const dialog = useRef<HTMLDialogElement>(null);
  const [port, setPort] = useState<PortOfTask | null>(null);
  const chosen = useChoices(panel);
  const { choices, fitting, kind, toggle } = chosen;
  const [title, setTitle] = useState(panel?.title ?? '');
  useEffect(() => dialog.current?.showModal(), []);
  const finish = (event: FormEvent) => {
    event.preventDefault();
    const sources = fitting.map((choice) => choice.source);
    if (sources.length > 0) onDone({ kind, title: title.trim().slice(0, 255) || sources.map(sourceText).join(', ').slice(0, 60), sources });
  };
  const heading = panel ? 'Change a panel' : 'Add a panel';
  return (
    <dialog ref={dialog} className="choose" aria-label={heading} onClose={onClose}>
      <form method="dialog" onSubmit={finish}>
        <h2>{heading}</h2>
        <div className="choose-columns">
          <PortList status={status} port={port} onPort={setPort} />
          <section aria-label="Fields">
            {port ? (
              <>
                <p>Fields of {port.task}.{port.port}</p>
                <div className="list"><FieldList key={port.task + '.' + port.port} port={port} chosen={choices} onToggle={toggle} /></div>
              </>
            ) : (
              <p className="quiet">Choose a port to see its fields.</p>
            )}
          </section>
        </div>
        <ChosenFields {...chosen} />
        <KindChoice {...chosen} />
        <div className="row">
          <input aria-label="Title" placeholder="Title" maxLength={255} value={title} onChange={(event) => setTitle(event.target.value)} />
          <button type="button" onClick={() => dialog.current?.close()}>Cancel</button>
          <ActionButton type="submit" className="primary" whyNot={fitting.length > 0 ? '' : choices.length > 0 ? 'needs a field that a ' + kindNames[kind] + ' can show' : 'needs a field of a port'}>{panel ? 'Change' : 'Add'}</ActionButton>
        </div>
      </form>
    </dialog>
  );
}
