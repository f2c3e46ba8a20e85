// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useRef, useState } from 'react';
import { ActionButton } from '../ActionButton';
import { FrameGraph } from './FrameGraph';
import { filmOf, frameOf, momentOf, type Film, type Moment, type PastAction, type PastTransition } from './film';
import { toneOfOutcome } from '../robot/outcome';
import { Panel } from '../panes/Panel';
import { FilmCharts } from './FilmCharts';
import { sliderSteps, stepOf, timeOf, timeText } from './slider';

const phases = ['prepare', 'commit', 'retire'];
const speeds = [0.001, 0.01, 0.1, 0.25, 1, 4];
/** A film shall not be over at once. */
const shortest = 2;

const signs: Record<Moment, string> = { waiting: '·', running: '…', done: '✓', failed: '✗', skipped: '–' };

function Actions({ name, actions, at }: { name: string; actions: PastAction[]; at: number }) {
  const moments = actions.map((action) => momentOf(action, at));
  return (
    <section aria-label={name === 'undo' ? 'Undo' : 'Phase ' + name}>
      <h3>
        {name} <span className="quiet">{moments.filter((one) => one === 'done').length} of {actions.length}</span>
      </h3>
      <ul className="actions">
        {actions.map((action, index) => {
          const moment = moments[index] ?? 'waiting';
          return (
            <li key={index} className={moment} data-moment={moment}>
              <span aria-hidden="true">{signs[moment]}</span> {action.label}
              <span className="hidden">, {moment}</span>
              {moment === 'failed' && action.error && <div className="bad">{action.error}</div>}
            </li>
          );
        })}
        {actions.length === 0 && <li className="quiet">nothing</li>}
      </ul>
    </section>
  );
}

/** Plays a film: its time, which goes on by itself while it plays. */
function usePlayer(film: Film) {
  const [at, setAt] = useState(0);
  const [playing, setPlaying] = useState(false);
  const [speed, setSpeed] = useState(speeds.filter((one) => one <= 1 && film.length / one >= shortest).pop() ?? speeds[0] ?? 1);
  const reached = useRef(0);
  reached.current = at;

  useEffect(() => {
    if (!playing) return;
    let last = performance.now();
    let frame = requestAnimationFrame(function step(now) {
      const next = Math.min(film.length, reached.current + ((now - last) / 1000) * speed);
      last = now;
      setAt(next);
      if (next >= film.length) setPlaying(false);
      else frame = requestAnimationFrame(step);
    });
    return () => cancelAnimationFrame(frame);
  }, [playing, speed, film]);

  const play = () => {
    if (!playing && at >= film.length) setAt(0);
    setPlaying(!playing);
  };
  const moveTo = (time: number) => [setPlaying(false), setAt(time)];
  return { at, playing, speed, setSpeed, play, moveTo };
}

type Player = ReturnType<typeof usePlayer>;

function PlayerBar({ film, player, onClose }: { film: Film; player: Player; onClose: () => void }) {
  const { at, playing, speed, setSpeed, play, moveTo } = player;
  const scale = { first: 0, last: film.length, steps: sliderSteps };
  return (
    <div className="bar film-bar">
      <button type="button" onClick={onClose}>Close the film</button>
      <ActionButton type="button" className="primary" tip onClick={play} whyNot={film.length > 0 ? '' : 'nothing was done'}>{playing ? 'Pause' : 'Play'}</ActionButton>
      <label>
        Speed{' '}
        <select value={speed} onChange={(event) => setSpeed(Number(event.target.value))}>
          {speeds.map((one) => <option key={one} value={one}>{one} ×</option>)}
        </select>
      </label>
      <label className="time-slider">
        <span className="hidden">Time of the film</span>
        <input
          type="range" min={0} max={sliderSteps} value={stepOf(scale, at)} aria-valuetext={timeText(at, film.length)}
          onChange={(event) => moveTo(timeOf(scale, Number(event.target.value)))}
        />
      </label>
      <output className="film-time">{timeText(at, film.length)} of {timeText(film.length, film.length)}</output>
    </div>
  );
}

function TransitionPanel({ film, at }: { film: Film; at: number }) {
  const { transition } = film;
  return (
    <Panel label="Past transition">
      <h2>{transition.from || 'empty'} → {transition.to || 'empty'}</h2>
      <p className={toneOfOutcome(transition.outcome) === 'good' ? 'good' : 'bad'}>
        {transition.outcome}
        {transition.undone && <>, {transition.undone}</>}
        {transition.cancelled_by && <>, cancelled by {transition.cancelled_by}</>}
      </p>
      {transition.who !== '' && <p className="quiet">Asked for by {transition.who}</p>}
      {transition.error && <p>{transition.error}</p>}
      {(film.before === null || film.after === null) && transition.actions.length > 0 && (
        <p className="note">What ran before or afterwards was not recorded, so only what the actions name is drawn.</p>
      )}
      {phases.map((name) => (
        <Actions key={name} name={name} actions={transition.actions.filter((action) => action.phase === name)} at={at} />
      ))}
      {transition.undo_actions.length > 0 && <Actions name="undo" actions={transition.undo_actions} at={at} />}
    </Panel>
  );
}

/** How a past transition went, as a film. */
export function FilmView({ transition, onClose }: { transition: PastTransition; onClose: () => void }) {
  const film = useMemo(() => filmOf(transition), [transition]);
  const player = usePlayer(film);
  const { at } = player;
  const ended = film.steps.filter((action) => momentOf(action, at) === 'done' || momentOf(action, at) === 'failed').length;
  // A frame changes only where an action ends.
  const frame = useMemo(() => frameOf(film, at), [film, ended, at >= film.length]); // eslint-disable-line react-hooks/exhaustive-deps
  return (
    <>
      <section className="main" aria-label="Film">
        <PlayerBar film={film} player={player} onClose={onClose} />
        {film.steps.length === 0 && !film.before ? (
          <p className="empty">Nothing was done: {transition.error ?? transition.outcome}</p>
        ) : (
          <>
            <FrameGraph label="Networks of the transition" frame={frame} />
            <FilmCharts film={film} at={at} onTime={player.moveTo} />
          </>
        )}
      </section>
      <TransitionPanel film={film} at={at} />
    </>
  );
}
