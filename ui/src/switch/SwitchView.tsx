// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useState } from 'react';
import { ActionButton } from '../ActionButton';
import { reason } from '../reason';
import type { Json } from '../robot/change';
import { FoldingGraph } from '../network/FoldingGraph';
import { useConnection, useDocument } from '../robot/hooks';
import { toneOfOutcome } from '../robot/outcome';
import type { Action, RobotEvent, Status, SwitchOutcome, Transition } from '../robot/types';
import { eventsOf } from '../events/filter';
import { ListPane, Panel } from '../panes/Panel';
import { OpenRequests, UndoList } from './OpenRequests';
import { undoingOf, undoneOf, type Undoing } from './undo';
import './switch.css';
import { differenceOf, estimateOf, progressOf, subjectOf, type Difference, type Progress } from './difference';

const phases = ['prepare', 'commit', 'retire'];

function seconds(value: number): string {
  return value < 0.001 ? (value * 1e6).toFixed(0) + ' µs' : value < 1 ? (value * 1e3).toFixed(1) + ' ms' : value.toFixed(1) + ' s';
}

/** A switch as it was planned when it was asked for: the picture stays while the robot changes. */
interface Attempt {
  transition: Transition;
  difference: Difference;
  after: number;
  outcome: SwitchOutcome | null;
  error: string | null;
}

interface PhaseProps {
  name: string;
  actions: Action[];
  progress: Map<number, Progress>;
  critical: Set<number>;
  undone: Set<number>;
}

function Phase({ name, actions, progress, critical, undone }: PhaseProps) {
  const done = actions.filter((action) => progress.get(action.id) === 'done').length;
  return (
    <section aria-label={'Phase ' + name}>
      <h3>
        {name} <span className="quiet">{done} of {actions.length}</span>
      </h3>
      <ul className="actions">
        {actions.map((action) => {
          const state = undone.has(action.id) && progress.get(action.id) === 'done' ? 'undone' : (progress.get(action.id) ?? 'waiting');
          return (
            <li key={action.id} className={state} data-progress={state}>
              <span aria-hidden="true">{{ done: '✓', failed: '✗', undone: '↶', waiting: '·' }[state]}</span> {subjectOf(action)}
              <span className="hidden">, {state}</span>
              {critical.has(action.id) && <span className="quiet" title="on the longest chain of actions that wait for each other"> ◆</span>}
            </li>
          );
        })}
        {actions.length === 0 && <li className="quiet">nothing</li>}
      </ul>
    </section>
  );
}

function Outcome({ attempt }: { attempt: Attempt }) {
  const { outcome, error } = attempt;
  if (error) return <p className="outcome bad" role="status">{error}</p>;
  if (!outcome) return <p className="outcome" role="status">The robot switches …</p>;
  const good = toneOfOutcome(outcome.outcome) === 'good';
  return (
    <div className={'outcome ' + (good ? 'good' : 'bad')} role="status">
      <strong>{outcome.outcome}</strong>
      {outcome.duration_s !== undefined && <span> after {seconds(outcome.duration_s)}, including {seconds(outcome.commit_s)} commit</span>}
      {outcome.error && <p>{outcome.error}</p>}
      {outcome.undo && (
        <p>
          {outcome.undo.restored ? 'Undone: what ran before runs again' : 'What ran before could not be restored'} ({outcome.undo.actions.length} actions,{' '}
          {seconds(outcome.undo.duration_s)})
        </p>
      )}
    </div>
  );
}

/** Which controller the robot is to switch to, and the transition to it; asked again when the robot runs something else. */
function usePlan(status: Status) {
  const connection = useConnection();
  const [chosen, setChosen] = useState<string | null>(null);
  const [force, setForce] = useState(false);
  const [plan, setPlan] = useState<Transition | null>(null);
  const [problem, setProblem] = useState<string | null>(null);
  const [history, setHistory] = useState<Transition[]>([]);
  useEffect(() => {
    if (chosen === null) return;
    let current = true;
    const ask = async () => {
      try {
        const found = await connection.call('diff', { controller: chosen, force });
        const past = await connection.call('history');
        if (!current) return;
        const refused = found as unknown as { outcome?: string; error?: string };
        setProblem(refused.outcome === 'refused' ? (refused.error ?? 'refused') : null);
        setPlan(refused.outcome === 'refused' ? null : (found as unknown as Transition));
        setHistory(past as unknown as Transition[]);
      } catch (error) {
        if (current) [setPlan(null), setProblem(reason(error))];
      }
    };
    void ask();
    return () => {
      current = false;
    };
  }, [connection, chosen, force, status.controller, status.state]);
  return { chosen, setChosen, force, setForce, plan, problem, setProblem, history };
}
type Planned = ReturnType<typeof usePlan>;

/** A switch that was asked for here. */
function useAttempt(status: Status, events: RobotEvent[], { plan, chosen, force }: Planned) {
  const connection = useConnection();
  const [takeOver, setTakeOver] = useState(false);
  const [attempt, setAttempt] = useState<Attempt | null>(null);
  const begin = async () => {
    if (!plan || chosen === null) return;
    const begun: Attempt = {
      transition: plan, difference: differenceOf(status, plan), after: events[events.length - 1]?.number ?? 0, outcome: null, error: null,
    };
    setAttempt(begun);
    try {
      setTakeOver(false); // who commands the robot next is asked about anew
      const outcome = await connection.call('switch', { controller: chosen, force, take_over: takeOver });
      setAttempt({ ...begun, outcome: outcome as unknown as SwitchOutcome });
    } catch (error) {
      setAttempt({ ...begun, error: reason(error) });
    }
  };
  const busy = attempt !== null && attempt.outcome === null && attempt.error === null;
  return { attempt, busy, begin, forget: () => setAttempt(null), takeOver, setTakeOver };
}
type Attempted = ReturnType<typeof useAttempt>;

interface ControllersProps {
  status: Status;
  chosen: string | null;
  onChoose: (name: string) => void;
  onProblem: (text: string | null) => void;
}

function Controllers({ status, chosen, onChoose, onProblem }: ControllersProps) {
  const connection = useConnection();
  const prepare = (controller: string, add: boolean) => {
    const names: Json[] = status.ready.map((one) => one.controller).filter((name) => name !== controller);
    connection.call('prepare', { controllers: add ? [...names, controller] : names }).then(
      () => onProblem(null),
      (error: Error) => onProblem(error.message),
    );
  };
  return (
    <ListPane label="Controllers">
      <h2>Controllers</h2>
      <ul className="plain">
        {status.controllers.map((name) => {
          const prepared = status.ready.find((one) => one.controller === name);
          return (
            <li key={name} className="controller">
              <button type="button" className="line" aria-pressed={chosen === name} onClick={() => onChoose(name)}>
                <span>{name}</span>
                {status.controller === name && <span className="badge tone-good">runs</span>}
                {prepared && <span className="badge">{prepared.ready ? 'prepared' : 'prepares'}</span>}
              </button>
              {connection.mayOperate && (
                <button type="button" className="small" aria-label={(prepared ? 'Do not prepare ' : 'Prepare ') + name} onClick={() => prepare(name, !prepared)}>
                  {prepared ? 'drop' : 'prepare'}
                </button>
              )}
            </li>
          );
        })}
      </ul>
      {status.commanded_by && <p className="quiet">Commanded by {status.commanded_by}</p>}
    </ListPane>
  );
}

function Legend({ difference }: { difference: Difference }) {
  return (
    <span className="legend">
      {(['unchanged', 'added', 'changed', 'removed'] as const).map((fate) => (
        <span key={fate} className={'badge fate-' + fate}>
          {fate}: {difference.tasks.filter((task) => task.fate === fate).length}
        </span>
      ))}
    </span>
  );
}

function DifferenceGraph({ difference }: { difference: Difference }) {
  const places = [...new Set(difference.tasks.map((task) => task.place))].sort();
  return (
    <FoldingGraph
      label="Difference of the controllers" quiet="fate-unchanged" mixed="fate-changed"
      groups={places.map((place) => ({ id: 'group:' + place, title: place === '' ? 'runtime' : place }))}
      nodes={difference.tasks.map((task) => ({
        id: task.id, group: 'group:' + task.place, title: task.id, detail: task.fate, look: 'fate-' + task.fate,
      }))}
      edges={difference.edges.map((edge) => ({ ...edge, look: 'fate-' + edge.fate }))}
    />
  );
}

interface DoItProps {
  status: Status;
  planned: Planned;
  attempted: Attempted;
  isEmpty: boolean;
}

/** Asks for the switch; nothing for who may not. */
function DoIt({ status, planned: { force, setForce }, attempted, isEmpty }: DoItProps) {
  const connection = useConnection();
  const { attempt, busy, begin, forget, takeOver, setTakeOver } = attempted;
  if (!connection.mayOperate) return null;
  return (
    <>
      <div className="doit">
        <ActionButton type="button" className="primary" whyNot={busy ? 'the robot switches' : attempt ? 'this plan has been asked for' : isEmpty ? 'nothing would change' : ''} onClick={() => void begin()}>
          Switch
        </ActionButton>
        <label>
          <input type="checkbox" checked={force} disabled={attempt !== null} aria-describedby="force-means" onChange={(event) => setForce(event.target.checked)} /> force
        </label>
        {status.commanded_by && connection.mayAdminister && (
          <label><input type="checkbox" checked={takeOver} onChange={(event) => setTakeOver(event.target.checked)} /> take over</label>
        )}
        {attempt && !busy && <button type="button" onClick={forget}>Plan again</button>}
      </div>
      <p id="force-means" className="quiet force-means">
        {attempt ? 'Set before the switch is asked for. ' : ''}Force kills the processes that go, instead of stopping their tasks first: for tasks that hang.
      </p>
    </>
  );
}

interface PhasesProps {
  actions: Action[];
  attempt: Attempt | null;
  events: RobotEvent[];
  critical: Set<number>;
}

/** How far the transition is, phase by phase. */
function Phases({ actions, attempt, events, critical }: PhasesProps) {
  const progress = progressOf(actions, attempt ? events : [], attempt?.after ?? Infinity);
  const undoing: Undoing = attempt ? undoingOf(events, attempt.after) : { why: null, steps: [] };
  const undone = undoneOf(actions, undoing);
  return (
    <>
      {attempt && <Outcome attempt={attempt} />}
      <UndoList undoing={undoing} />
      {phases.map((name) => (
        <Phase key={name} name={name} actions={actions.filter((action) => (action.phase ?? 'commit') === name)} progress={progress} undone={undone} critical={critical} />
      ))}
    </>
  );
}

interface TransitionProps {
  status: Status;
  transition: Transition;
  events: RobotEvent[];
  planned: Planned;
  attempted: Attempted;
}

function TransitionPart({ status, transition, events, planned, attempted }: TransitionProps) {
  const { actions } = transition;
  const { history } = planned;
  const estimate = useMemo(() => estimateOf(actions, history), [actions, history]);
  return (
    <>
      <p>
        {actions.length} actions
        {estimate.known > 0 && <>; the longest chain takes about {seconds(estimate.seconds)} <span className="quiet">(from what {estimate.known} of them took before)</span></>}
      </p>
      <DoIt status={status} planned={planned} attempted={attempted} isEmpty={actions.length === 0} />
      <Phases actions={actions} attempt={attempted.attempt} events={events} critical={estimate.known > 0 ? estimate.critical : new Set()} />
    </>
  );
}

function NoDifference({ hasOthers }: { hasOthers: boolean }) {
  return (
    <p className="empty">
      {hasOthers ? (
        'Choose a controller at the left: its difference to what runs is drawn here before anything happens.'
      ) : (
        <>
          This robot has no other controller to switch to; the difference to what runs would be drawn here. Make one with <em>New controller</em> in <a href="#edit">Edit</a>, or name
          its file under <code>controllers</code> in the robot file, and take it with <code>segue apply</code>.
        </>
      )}
    </p>
  );
}

export function SwitchView({ status }: { status: Status }) {
  const shownEvents = useDocument('events');
  const events = useMemo(() => eventsOf(shownEvents?.value), [shownEvents]);
  const planned = usePlan(status);
  const { chosen, setChosen, plan, problem, setProblem } = planned;
  const attempted = useAttempt(status, events, planned);
  const { attempt, forget } = attempted;
  const transition = attempt?.transition ?? plan;
  const difference = attempt?.difference ?? (plan ? differenceOf(status, plan) : null);
  return (
    <div className="view switch">
      <Controllers status={status} chosen={chosen} onChoose={(name) => [setChosen(name), forget()]} onProblem={setProblem} />
      <section className="main" aria-label="Difference">
        <div className="bar">
          <span>
            {chosen === null ? 'Choose a controller' : (transition?.from || 'empty') + ' → ' + ((transition?.to ?? chosen) || 'empty')}
          </span>
          {difference && <Legend difference={difference} />}
        </div>
        {difference ? <DifferenceGraph difference={difference} /> : !problem && <NoDifference hasOthers={status.controllers.some((name) => name !== status.controller)} />}
      </section>
      <Panel label="Transition">
        <h2>Transition</h2>
        <OpenRequests status={status} />
        {problem && <p className="bad" role="alert">{problem}</p>}
        {transition && <TransitionPart status={status} transition={transition} events={events} planned={planned} attempted={attempted} />}
      </Panel>
    </div>
  );
}
