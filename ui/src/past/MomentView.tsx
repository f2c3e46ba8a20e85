// SPDX-License-Identifier: Apache-2.0
import { useMemo } from 'react';
import { FrameGraph } from './FrameGraph';
import { filmOf, frameOf, frameOfNetwork, networkOf } from './film';
import { toneOfOutcome } from '../robot/outcome';
import { Panel } from '../panes/Panel';
import { localText } from '../local_time';
import { LocalTime } from '../LocalTime';
import { stepOf, timeOf } from './slider';
import { useMoment, useTransition, type PastMoment, type Span } from './usePast';

const sliderSteps = 1000;

interface Props {
  span: Span;
  /** Seconds since 1970. */
  time: number;
  changed: string;
  onTime: (time: number) => void;
  onPlay: (id: number) => void;
}

/** The network that ran then, or how far the transition was; null: not known. */
function useFrame(moment: PastMoment | null) {
  const { answer: transition } = useTransition(moment?.transition ?? null);
  return useMemo(() => {
    if (!moment?.known) return null;
    if (transition && moment.transition === transition.id) {
      return frameOf(filmOf(transition), Math.max(0, moment.time_s - (transition.ended_s - (transition.lasted_s ?? 0))));
    }
    const network = networkOf(moment.network);
    return network && frameOfNetwork(network);
  }, [moment, transition]);
}

/** The time, and where transitions were. */
function TimeBar({ span, time, onTime }: Pick<Props, 'span' | 'time' | 'onTime'>) {
  const first = span.first_s ?? 0;
  const last = Math.max(span.last_s ?? 0, first);
  const scale = { first, last, steps: sliderSteps };
  const next = (way: 1 | -1) => {
    const times = span.marks.map((mark) => mark.time_s).sort((a, b) => way * (a - b));
    const found = times.find((one) => way * (one - time) > 1e-6);
    onTime(found ?? (way > 0 ? last : first));
  };
  return (
    <div className="bar film-bar">
      <button type="button" onClick={() => next(-1)} title="The transition before">◂ earlier</button>
      <div className="time-slider">
        <label>
          <span className="hidden">Time</span>
          <input
            type="range" min={0} max={sliderSteps} value={stepOf(scale, time)} aria-valuetext={localText(time * 1000)}
            onChange={(event) => onTime(timeOf(scale, Number(event.target.value)))}
          />
        </label>
        <div className="marks" aria-hidden="true">
          {span.marks.map((mark) => (
            <span key={mark.id} className={toneOfOutcome(mark.outcome) === 'good' ? 'mark' : 'mark bad'} style={{ left: (100 * (mark.time_s - first)) / (last - first || 1) + '%' }} />
          ))}
        </div>
      </div>
      <button type="button" onClick={() => next(1)} title="The transition behind">later ▸</button>
      <output><LocalTime at={time * 1000} /></output>
    </div>
  );
}

/** The notes, the controller, the transition and the missions of that time. */
function Facts({ moment, onPlay }: { moment: PastMoment; onPlay: (id: number) => void }) {
  return (
    <>
      {moment.notes.map((note) => <p key={note} className="note">{note[0]?.toUpperCase() + note.slice(1)}.</p>)}
      {moment.known && (
        <p data-controller={moment.controller ?? ''}>
          The robot ran <strong>{moment.controller || 'nothing with a name'}</strong>
          {moment.version && <span className="quiet"> ({moment.version})</span>}
          {moment.since_s !== null && moment.transition === null && <>, as recorded at <LocalTime at={moment.since_s * 1000} /></>}.
        </p>
      )}
      {moment.transition !== null && (
        <p>
          A transition was in progress. <button type="button" onClick={() => onPlay(moment.transition ?? 0)}>Play it</button>
        </p>
      )}
      <h3>missions</h3>
      {moment.missions.length === 0 && <p className="quiet">{moment.known ? 'none' : 'not known'}</p>}
      {moment.missions.map((one) => (
        <p key={one.mission + one.who}>
          <strong>{one.mission}</strong> <span className="quiet">{one.who}</span>
          {one.actions.length > 0 && <>: {one.actions.join(', ')}</>}
        </p>
      ))}
      <h3>differences found until then</h3>
      {moment.differences.length === 0 && <p className="quiet">none</p>}
      {moment.differences.map((one, index) => <p key={index}>{one}</p>)}
      <p className="quiet">States of tasks are those when the transition before ended; what changed by itself since then is among the differences, if it was found.</p>
    </>
  );
}

/** The robot as it was at a time. */
export function MomentView({ span, time, changed, onTime, onPlay }: Props) {
  const { answer: moment, problem } = useMoment(time, changed);
  const frame = useFrame(moment);
  return (
    <>
      <section className="main" aria-label="The robot at a time">
        <TimeBar span={span} time={time} onTime={onTime} />
        {frame ? <FrameGraph label="Network at that time" frame={frame} /> : <p className="empty">{moment ? 'What ran then is not known.' : ''}</p>}
      </section>
      <Panel label="At that time">
        <h2>At that time</h2>
        {problem && <p className="bad" role="alert">{problem}</p>}
        {moment && <Facts moment={moment} onPlay={onPlay} />}
      </Panel>
    </>
  );
}
