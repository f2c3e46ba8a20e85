// SPDX-License-Identifier: Apache-2.0
import { useState, type ReactNode } from 'react';
import { ActionButton } from '../ActionButton';
import { Panel } from '../panes/Panel';
import { preemptedBy, whyNotAt, type Control } from './control';
import { lifeWords, type Life, type Mission, type PlanState } from './mission';
import type { Requests } from './requests';
import { isContainer } from './states';
import type { KnownValues } from './values';
import { ValuesTable } from './ValuesTable';

const tones: Record<Life, string> = { idle: 'idle', running: 'come', waiting: 'wait', next: 'warn', done: 'good', failed: 'bad' };

function GoOn({ path, lives, kinds, requests }: { path: string; lives: Map<string, Life>; kinds: Map<string, string>; requests: Requests }) {
  const [confirms, setConfirms] = useState(false);
  const preempted = preemptedBy(path, lives);
  const reason = requests.asked.length > 0 ? 'the mission has not heard yet what it was asked for' : whyNotAt(path, lives, kinds);
  const go = () => {
    setConfirms(false);
    requests.ask({ what: 'go_on_at', at: path });
  };
  if (!confirms || preempted.length === 0) {
    return (
      <ActionButton
        type="button" whyNot={reason} title="The mission goes on at this state, with the inputs that it would have now" onClick={() => (preempted.length > 0 ? setConfirms(true) : go())}
      >
        Go on here{preempted.length > 0 ? ' …' : ''}
      </ActionButton>
    );
  }
  return (
    <span role="group" aria-label={'Go on at ' + path} className="confirm">
      {preempted.join(', ')} {preempted.length > 1 ? 'are' : 'is'} under way and will be preempted.{' '}
      <ActionButton type="button" className="primary" whyNot={reason} onClick={go}>Preempt and go on here</ActionButton>{' '}
      <button type="button" onClick={() => setConfirms(false)}>Cancel</button>
    </span>
  );
}

interface Props {
  state: PlanState;
  mission: Mission;
  control: Control | null;
  lives: Map<string, Life>;
  /** For what the state waits; undefined: it does not. */
  waits: string[] | undefined;
  /** The kinds of all states of the plan, by path. */
  kinds: Map<string, string>;
  requests: Requests;
  breakpoints: string[];
  onBreak: (path: string) => void;
  isOpen: boolean;
  onToggle: (path: string) => void;
  known: KnownValues | null;
  onClose: () => void;
  /** The facts that the chart has about the state. */
  children?: ReactNode;
}

/** A state of the mission: what it is, its values, and what can be done with it. */
export function StatePanel({ state, mission, control, lives, waits, kinds, requests, breakpoints, onBreak, isOpen, onToggle, known, onClose, children }: Props) {
  const { path } = state;
  const life = lives.get(path) ?? 'idle';
  const steps = control?.steps ?? false;
  const asks = steps && requests.may;
  const action = state.action && state.action !== path ? 'action ' + state.action : '';
  const library = state.library ? 'library ' + state.library : '';
  const name = path === '' ? mission.mission : path;
  return (
    <Panel label={'State ' + name}>
      <header>
        <h2>{state.title || name}</h2>
        <button type="button" aria-label="Close" onClick={onClose}>×</button>
      </header>
      <p className="quiet">
        {[path === state.title ? '' : path, state.kind, action, library].filter((part) => part !== '').join(', ')}
      </p>
      <p className="row">
        <span className={'badge tone-' + tones[life]}>{lifeWords[life]}</span>
        {isContainer(state) && path !== '' && (
          <button type="button" className="small" aria-expanded={isOpen} onClick={() => onToggle(path)}>{isOpen ? 'Close in the graph' : 'Open in the graph'}</button>
        )}
      </p>
      {waits && <ul className="plain waits">{waits.map((wait) => <li key={wait}>waits for {wait}</li>)}</ul>}
      {steps && path !== '' && (
        <p className="row">
          <label className="break">
            <input type="checkbox" checked={breakpoints.includes(path)} disabled={!requests.may} aria-keyshortcuts="b" onChange={() => onBreak(path)} /> breakpoint{!requests.may && <span className="quiet"> (set by who may operate)</span>}
            {breakpoints.includes(path) !== control?.breakpoints.includes(path) && <span className="quiet"> asked …</span>}
          </label>
          {requests.may && mission.state !== 'stopping' && <GoOn path={path} lives={lives} kinds={kinds} requests={requests} />}
        </p>
      )}
      {steps && <><h3>Values</h3><ValuesTable known={known} asks={asks} /></>}
      {children && <><h3>In the chart</h3>{children}</>}
    </Panel>
  );
}
