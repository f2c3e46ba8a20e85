// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useRef, useState } from 'react';
import { Graph } from '../network/Graph';
import type { Control } from './control';
import { lifeWords, type Life, type Mission, type Plan } from './mission';
import { idOf, isContainer, openFor, openLevels, pathOf, stateGraphOf } from './states';
import type { KnownValues } from './values';
import { ValuesTip } from './ValuesTable';

/** How long the pointer rests on a state before its values are shown, and how long it may be elsewhere. */
const restsFor = 300;
const awayFor = 200;

interface Props {
  plan: Plan;
  mission: Mission;
  control: Control | null;
  lives: Map<string, Life>;
  waits: Map<string, string[]>;
  selected: string | null;
  onSelect: (path: string | null) => void;
  /** The breakpoints as they will be once all requests are answered. */
  breakpoints: string[];
  mayBreak: boolean;
  onBreak: (path: string) => void;
  open: Set<string>;
  onOpen: (open: Set<string>) => void;
  onToggle: (path: string) => void;
  /** See useLayout(). */
  onCrowded: (selected: string | null) => boolean;
  /** Followed states are opened and moved into view. */
  follows: boolean;
  onFollows: (follows: boolean) => void;
  followed: string[];
  /** The state that the pointer rests on, or that has the focus of the keyboard. */
  peeked: string | null;
  onPeek: (path: string | null) => void;
  valuesOf: (path: string) => KnownValues | null;
}

/** Why a run cannot be stepped, and what to do. */
function Unsteppable() {
  return (
    <span className="quiet" title="segue mission run FILE --mode sequential">
      A concurrent run can only be paused. To step it, and for breakpoints and values, run it with --mode sequential.
    </span>
  );
}

const shownLives = [['running', 'come'], ['waiting', 'wait'], ['next', 'warn'], ['done', 'good'], ['failed', 'bad']] as const;

function Legend() {
  return <span className="legend" role="group" aria-label="Legend">{shownLives.map(([life, tone]) => <span key={life} className={'badge tone-' + tone}>{lifeWords[life]}</span>)}</span>;
}

/** Hands on where the pointer rests, not what it passes. */
function usePeek(onPeek: (path: string | null) => void): (id: string | null) => void {
  const timer = useRef<ReturnType<typeof setTimeout> | undefined>(undefined);
  useEffect(() => () => clearTimeout(timer.current), []);
  return (id) => {
    clearTimeout(timer.current);
    timer.current = setTimeout(() => onPeek(id === null ? null : pathOf(id)), id === null ? awayFor : restsFor);
  };
}

/** Followed states can be seen, and stay selected where they were. */
function useFollow({ followed, follows, selected, onSelect, open, onOpen }: Props): void {
  const place = JSON.stringify(followed);
  const before = useRef<string[]>([]);
  useEffect(() => {
    if (!follows || followed.length === 0) return;
    const hidden = openFor(followed).filter((path) => !open.has(path));
    if (hidden.length > 0) onOpen(new Set([...open, ...hidden]));
    if (selected !== null && before.current.includes(selected) && !followed.includes(selected)) onSelect(followed[0] ?? null);
    before.current = followed;
    // A state that somebody opens, closes or selects there afterwards stays so.
  }, [place, follows]);
}

/** The values of the state that the pointer rests on; the panel has those of the selected one. */
function tipOf({ control, mayBreak, peeked, selected, valuesOf }: Props) {
  if (peeked === null || peeked === selected) return null;
  const values = valuesOf(peeked);
  const asks = control?.steps && mayBreak;
  return values || asks ? { id: idOf(peeked), content: <ValuesTip path={peeked} known={values} /> } : null;
}

/** The states as nested graph: which run, come next and have breakpoints. */
export function States(props: Props) {
  const { plan, mission, control, lives, waits, selected, onSelect, breakpoints, mayBreak, onBreak, open, onOpen, onToggle, onPeek, follows, onFollows, followed, onCrowded } = props;
  const [withFlows, setWithFlows] = useState(false);
  const steps = control?.steps ?? false;
  const breaks = useMemo(() => (steps ? { at: breakpoints, fixed: !mayBreak } : null), [steps, breakpoints, mayBreak]);
  const graph = useMemo(() => stateGraphOf(plan, { lives, waits }, open, withFlows, breaks), [plan, lives, waits, open, withFlows, breaks]);
  const containers = useMemo(() => new Set(plan.states.filter((state) => state.path !== '' && isContainer(state)).map((state) => state.path)), [plan]);
  const peek = usePeek(onPeek);
  useFollow(props);
  return (
    <section className="states" aria-label="States">
      <div className="bar">
        <span className="quiet">{plan.states.length - 1 || 1} states{plan.complete ? '' : ' (more are not shown)'}</span>
        <label><input type="checkbox" checked={withFlows} onChange={(event) => setWithFlows(event.target.checked)} /> data flows</label>
        {mission.state !== 'ended' && (
          <label title="The state that runs, or before which the mission is held, is opened and moved into view; where it was selected, it stays so">
            <input type="checkbox" checked={follows} onChange={(event) => onFollows(event.target.checked)} /> follow
          </label>
        )}
        <button type="button" className="small" onClick={() => onOpen(containers)}>open all</button>
        <button type="button" className="small" onClick={() => onOpen(new Set())}>close all</button>
        {control && !control.steps && mission.state !== 'ended' && <Unsteppable />}
        <Legend />
      </div>
      <Graph
        label="Graph of states" needsLabels groups={graph.groups} nodes={graph.nodes} edges={graph.edges}
        selected={selected === null ? null : idOf(selected)} onSelect={(id) => onSelect(id === null ? null : pathOf(id))} onToggle={(id) => onToggle(pathOf(id))}
        onMark={(id) => onBreak(pathOf(id))} markKey="b" follow={follows && followed[0] !== undefined ? idOf(followed[0]) : null} onCrowded={() => onCrowded(selected)}
        onPeek={peek} tip={tipOf(props)}
      />
    </section>
  );
}

interface Opened {
  /** The structure that it is for. */
  of: string | null;
  level: number;
  /** The containers that are open since somebody has opened or closed one; null: nobody has. */
  paths: Set<string> | null;
  /** Those around what was selected when others closed. */
  around: string[];
}

/**
 * Which containers of a plan are open; anew for one with other states. Until somebody opens or closes one, those around the
 * states that are `shown` are, and as many others as can be read.
 */
export function useOpen(plan: Plan | null, shown: string[]) {
  const structure = plan && JSON.stringify(plan.states.map((state) => state.path));
  const [kept, setKept] = useState<Opened>({ of: null, level: 0, paths: null, around: [] });
  // eslint-disable-next-line react-hooks/exhaustive-deps
  const levels = useMemo(() => (plan ? openLevels(plan) : []), [structure]);
  const { level, paths, around: chosen } = kept.of === structure ? kept : { level: 0, paths: null, around: [] };
  const around = JSON.stringify([...openFor(shown), ...chosen]);
  const atFirst = useMemo(() => new Set([...(levels[level] ?? []), ...(JSON.parse(around) as string[])]), [levels, level, around]);
  const setOpen = (open: Set<string>) => setKept({ of: structure, level, paths: open, around: [] });
  /** Closes more, but not around the state that is selected; whether it does. */
  const onCrowded = (selected: string | null) => {
    const stays = new Set([...openFor(selected === null ? [] : [selected]).filter((path) => atFirst.has(path)), ...chosen]);
    const next = levels.findIndex((those, index) => index > level && [...atFirst].some((path) => !those.has(path) && !stays.has(path) && !openFor(shown).includes(path)));
    if (paths !== null || next < 0) return false;
    setKept({ of: structure, level: next, paths, around: [...stays] });
    return true;
  };
  return { open: paths ?? atFirst, setOpen, onCrowded };
}
