// SPDX-License-Identifier: Apache-2.0
import type { Action, DurationRange, PlannedTransition } from '../robot/types';
import { durationText } from '../units';
import { subjectOf, type Progress } from './difference';
import { countsText, typicalOf, unmeasuredText } from './plan';

const phases = ['prepare', 'commit', 'retire'] as const;

function Range({ name, range }: { name: string; range: DurationRange | undefined }) {
  if (!range || range.high <= 0) return null;
  return <tr><th scope="row">{name}</th>{[range.low, range.typical, range.high].map((one, index) => <td key={index} className="number">{durationText(one)}</td>)}</tr>;
}

/** The numbers of the transition and the time that it takes, as the robot says, before anything happens. */
export function PlanSummary({ transition }: { transition: PlannedTransition }) {
  const { actions, counts, order, estimate_s: estimate } = transition;
  return (
    <>
      <p>
        {actions.length} actions{counts && actions.length > 0 && <>, {counts['state_changes']} of them state changes; order {order}</>}
        <span className="quiet counts">{countsText(counts)}</span>
      </p>
      {estimate && actions.length > 0 && (
        <table className="estimate">
          <caption className="hidden">How long it takes</caption>
          <thead><tr><th scope="col">expected</th><th scope="col">at least</th><th scope="col">typically</th><th scope="col">at most</th></tr></thead>
          <tbody>
            <Range name="total" range={estimate.total} />
            {phases.map((phase) => <Range key={phase} name={phase} range={estimate[phase]} />)}
          </tbody>
        </table>
      )}
      {estimate && <p className="quiet">{unmeasuredText(estimate.never_measured, actions.length)}</p>}
    </>
  );
}

/** The changes of the network: tasks and connections that come and go, and properties with their old and new values. */
export function Changes({ changes }: { changes: string[] | undefined }) {
  if (!changes || changes.length === 0) return null;
  return (
    <section aria-label="Changes">
      <h3>changes <span className="quiet">{changes.length}</span></h3>
      <ul className="actions">{changes.map((change) => <li key={change}>{change.replaceAll(' -> ', ' → ')}</li>)}</ul>
    </section>
  );
}

interface PhaseProps {
  name: string;
  actions: Action[];
  progress: Map<number, Progress>;
  typical: Map<number, number>;
  critical: Set<number>;
  undone: Set<number>;
}

function Phase({ name, actions, progress, typical, critical, undone }: PhaseProps) {
  const done = actions.filter((action) => progress.get(action.id) === 'done').length;
  return (
    <section aria-label={'Phase ' + name}>
      <h3>
        {name} <span className="quiet">{done} of {actions.length}</span>
      </h3>
      <ul className="actions">
        {actions.map((action) => {
          const state = undone.has(action.id) && progress.get(action.id) === 'done' ? 'undone' : (progress.get(action.id) ?? 'waiting');
          const takes = typical.get(action.id);
          return (
            <li key={action.id} className={state} data-progress={state}>
              <span aria-hidden="true">{{ done: '✓', failed: '✗', undone: '↶', waiting: '·' }[state]}</span>
              <span className="quiet"> {action.id}</span> {subjectOf(action)}
              {action.policy && action.policy !== 'data' && <> ({action.policy}{action.size ? ' of ' + action.size : ''})</>}
              <span className="hidden">, {state}</span>
              {critical.has(action.id) && <span className="quiet" title="on the critical path: the chain of actions that decides how long it takes"> ◆</span>}
              {takes !== undefined && <span className="quiet takes" title="what it typically takes"> {durationText(takes)}</span>}
            </li>
          );
        })}
        {actions.length === 0 && <li className="quiet">nothing</li>}
      </ul>
    </section>
  );
}

/** The actions with their numbers, in the order of the transition, phase by phase; how far each is. */
export function Phases({ transition, progress, undone }: { transition: PlannedTransition; progress: Map<number, Progress>; undone: Set<number> }) {
  const { actions, estimate_s: estimate } = transition;
  const shared = { progress, undone, typical: typicalOf(transition), critical: new Set(estimate?.critical_path) };
  return <>{phases.map((name) => <Phase key={name} name={name} actions={actions.filter((action) => (action.phase ?? 'commit') === name)} {...shared} />)}</>;
}
