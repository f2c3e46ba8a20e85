// SPDX-License-Identifier: Apache-2.0
import { useEffect } from 'react';
import { ActionButton } from '../ActionButton';
import { isTyping } from '../keys';
import { stepButtons, type Control } from './control';
import type { Mission } from './mission';
import { wordsOf, type Requests } from './requests';

interface Props {
  mission: Mission;
  control: Control | null;
  requests: Requests;
  onSelect: (path: string) => void;
}

/** The states before which the mission is held; a click selects one. */
function HeldAt({ at, onSelect }: { at: string[]; onSelect: (path: string) => void }) {
  if (at.length === 0) return null;
  return (
    <span className="held">
      held before
      {at.map((path) => <button key={path} type="button" className="small" onClick={() => onSelect(path)}>{path || 'the beginning'}</button>)}
    </span>
  );
}

/** Pause, steps and stop, by buttons and keys; what the mission has not heard yet is shown as such. */
export function Controls({ mission, control, requests, onSelect }: Props) {
  const { state } = mission;
  const { may, asked, ask } = requests;
  const waits = state === 'stopping' ? 'the mission is being stopped' : asked.length > 0 ? 'the mission has not heard yet what it was asked for' : '';
  const busy = waits !== '';
  const stops = state === 'stopping' || asked.some((one) => one.request.what === 'stop');
  const steps = control?.steps ? stepButtons(state, control, busy) : [];
  const active = may && state !== 'ended';
  const goOn = state === 'paused' ? ({ what: 'resume' } as const) : ({ what: 'pause' } as const);

  useEffect(() => {
    if (!active) return;
    const press = (event: KeyboardEvent) => {
      if (isTyping(event) || event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
      const step = steps.find((one) => one.key === event.key);
      if (step && step.reason === '') ask({ what: 'step', how: step.how });
      if (event.key === 'c' && !busy) ask(goOn);
    };
    window.addEventListener('keydown', press);
    return () => window.removeEventListener('keydown', press);
  });

  return (
    <>
      {active && (
        <span role="group" aria-label="Steer the mission" className="steer">
          <ActionButton type="button" tip whyNot={waits} aria-keyshortcuts="c" title="Key c" onClick={() => ask(goOn)}>{goOn.what === 'resume' ? 'Resume' : 'Pause'}</ActionButton>
          {steps.map(({ how, label, key, title, reason }) => (
            <ActionButton key={how} type="button" tip whyNot={reason} aria-keyshortcuts={key} title={title + ' (key ' + key + ')'} onClick={() => ask({ what: 'step', how })}>
              {label}
            </ActionButton>
          ))}
          <ActionButton type="button" tip whyNot={stops ? 'it is asked to stop' : ''} onClick={() => ask({ what: 'stop' })}>Stop</ActionButton>
        </span>
      )}
      <span className="news">
        {asked.length > 0 && <span role="status">asked to {asked.map((one) => wordsOf(one.request)).join(', ')} … </span>}
        {asked.length === 0 && control?.at && <HeldAt at={control.at} onSelect={onSelect} />}
        {asked.length === 0 && state === 'paused' && control && !control.at && 'what is under way ends first'} <span className="who">by {mission.who}</span>
      </span>
    </>
  );
}

export function StateBadge({ mission }: { mission: Mission }) {
  const lost = mission.outcome === 'lost';
  const bad = lost || mission.outcome === 'aborted';
  const text = mission.state === 'ended' ? (lost ? 'killed or lost' : 'ended: ' + (mission.outcome ?? '')) : mission.state;
  const tone = mission.state === 'running' ? 'good' : mission.state !== 'ended' ? 'warn' : bad ? 'bad' : 'idle';
  return <span className={'badge tone-' + tone} role="status">{text}</span>;
}
