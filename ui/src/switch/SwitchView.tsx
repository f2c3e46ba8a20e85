// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useState } from 'react';
import { ActionButton } from '../ActionButton';
import { Name } from '../Name';
import { reason } from '../reason';
import type { Json } from '../robot/change';
import { FoldingGraph } from '../network/FoldingGraph';
import { titleOf } from '../network/graph';
import { useConnection, useDocument } from '../robot/hooks';
import { toneOfOutcome } from '../robot/outcome';
import type { PlannedTransition, RobotEvent, Status, SwitchOutcome } from '../robot/types';
import { eventsOf } from '../events/filter';
import { ListPane, Panel } from '../panes/Panel';
import { OpenRequests, UndoList } from './OpenRequests';
import { undoingOf, undoneOf, type Undoing } from './undo';
import './switch.css';
import { durationText } from '../units';
import { differenceOf, progressOf, type Difference } from './difference';
import { Changes, Phases, PlanSummary } from './Plan';

/** A switch as it was planned when it was asked for: the picture stays while the robot changes. */
interface Attempt {
  transition: PlannedTransition;
  difference: Difference;
  after: number;
  outcome: SwitchOutcome | null;
  error: string | null;
}

function Outcome({ attempt }: { attempt: Attempt }) {
  const { outcome, error } = attempt;
  if (error) return <p className="outcome bad" role="status">{error}</p>;
  if (!outcome) return <p className="outcome" role="status">The robot switches …</p>;
  const good = toneOfOutcome(outcome.outcome) === 'good';
  return (
    <div className={'outcome ' + (good ? 'good' : 'bad')} role="status">
      <strong>{outcome.outcome}</strong>
      {outcome.duration_s !== undefined && <span> after {durationText(outcome.duration_s)}, including {durationText(outcome.commit_s)} commit</span>}
      {outcome.error && <p>{outcome.error}</p>}
      {outcome.undo && (
        <p>
          {outcome.undo.restored ? 'Undone: what ran before runs again' : 'What ran before could not be restored'} ({outcome.undo.actions.length} actions,{' '}
          {durationText(outcome.undo.duration_s)})
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
  const [plan, setPlan] = useState<PlannedTransition | null>(null);
  const [problem, setProblem] = useState<string | null>(null);
  useEffect(() => {
    if (chosen === null) return;
    let current = true;
    const ask = async () => {
      try {
        const found = await connection.call('diff', { controller: chosen, force });
        if (!current) return;
        const refused = found as unknown as { outcome?: string; error?: string };
        setProblem(refused.outcome === 'refused' ? (refused.error ?? 'refused') : null);
        setPlan(refused.outcome === 'refused' ? null : (found as unknown as PlannedTransition));
      } catch (error) {
        if (current) [setPlan(null), setProblem(reason(error))];
      }
    };
    void ask();
    return () => {
      current = false;
    };
  }, [connection, chosen, force, status.controller, status.state]);
  return { chosen, setChosen, force, setForce, plan, problem, setProblem };
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
                <span><Name text={name} /></span>
                {status.controller === name && <span className="badge tone-good">runs</span>}
                {prepared && <span className="badge">{prepared.ready ? 'prepared' : 'prepares'}</span>}
              </button>
              {connection.mayOperate && (
                <button type="button" className="small" title={prepared ? 'It is kept prepared no longer' : 'Keeps it prepared, for a fast switch'} onClick={() => prepare(name, !prepared)}>
                  {prepared ? 'drop' : 'prepare'}<span className="hidden"> {name}</span>
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
      groups={places.map((place) => ({ id: 'group:' + place, title: titleOf(place) }))}
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

/** How far the transition is, phase by phase. */
function Course({ transition, attempt, events }: { transition: PlannedTransition; attempt: Attempt | null; events: RobotEvent[] }) {
  const { actions } = transition;
  const progress = progressOf(actions, attempt ? events : [], attempt?.after ?? Infinity);
  const undoing: Undoing = attempt ? undoingOf(events, attempt.after) : { why: null, steps: [] };
  return (
    <>
      {attempt && <Outcome attempt={attempt} />}
      <UndoList undoing={undoing} />
      {!attempt && <Changes changes={transition.changes} />}
      <Phases transition={transition} progress={progress} undone={undoneOf(actions, undoing)} />
    </>
  );
}

interface TransitionProps {
  status: Status;
  transition: PlannedTransition;
  events: RobotEvent[];
  planned: Planned;
  attempted: Attempted;
}

function TransitionPart({ status, transition, events, planned, attempted }: TransitionProps) {
  return (
    <>
      <PlanSummary transition={transition} />
      <DoIt status={status} planned={planned} attempted={attempted} isEmpty={transition.actions.length === 0} />
      <Course transition={transition} attempt={attempted.attempt} events={events} />
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
