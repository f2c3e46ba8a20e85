// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useState } from 'react';
import { ActionButton } from '../ActionButton';
import { isTyping } from '../keys';
import { Splitter } from '../panes/Splitter';
import { reason } from '../reason';
import { useConnection, useDocument } from '../robot/hooks';
import { controlOf, withToggled } from './control';
import { Controls, StateBadge } from './Controls';
import { GanttChart } from './GanttChart';
import { livesOf, missionOf, planOf, planProblem, type Life, type Mission, type PlanState } from './mission';
import { NodeFacts, NodePanel } from './NodePanel';
import { PastRuns } from './PastRuns';
import { breakpointsAfter, useRequests } from './requests';
import { runOfFile, runOfMission, stateOf, type Run } from './run';
import { StatePanel } from './StatePanel';
import { StartMission } from './StartMission';
import { States, useOpen } from './States';
import { followedOf } from './states';
import { waitsOf, withWaiting } from './waiting';
import { useValues, type KnownValues } from './values';
import './missions.css';

function FileButton({ onRun, onProblem }: { onRun: (run: Run) => void; onProblem: (text: string) => void }) {
  const read = async (file: File | undefined) => {
    if (!file) return;
    try {
      onRun(runOfFile(await file.text()));
      onProblem('');
    } catch (error) {
      onProblem(file.name + ': ' + reason(error));
    }
  };
  return (
    <label className="file">
      Open a recorded run
      <input type="file" accept=".json,application/json" onChange={(event) => void read(event.target.files?.[0])} />
    </label>
  );
}

function NoMission({ mayStart }: { mayStart: boolean }) {
  return (
    <p className="empty">
      No mission has commanded the robot since its runtime began; its states, and when each of them ran, would be here. Start one {mayStart && <>with <em>Start a mission</em>, or </>}with <code>segue mission run FILE</code>; choose one of <em>Past runs</em>, or
      a file at <em>Open a recorded run</em>.
    </p>
  );
}

/** The element that was clicked on: a row of the chart by its label, or a state by its path. */
interface Choice {
  row?: string;
  path: string;
}

/** Rows come and go, a node keeps its name; of a state that was chosen in the graph, the last turn. */
function rowOf(run: Run | null, chosen: Choice | null): number {
  if (!run || !chosen) return -1;
  const last = run.rows.map((row) => stateOf(row.label)).lastIndexOf(chosen.path);
  return chosen.row === undefined ? last : run.rows.findIndex((row) => row.label === chosen.row);
}

/** The mission that commands or has commanded the robot. */
function useMission() {
  const shown = useDocument('mission');
  const mission = useMemo(() => missionOf(shown?.value), [shown]);
  const control = useMemo(() => controlOf(mission), [mission]);
  const live = useMemo(() => (mission ? runOfMission(mission) : null), [mission]);
  const waits = useMemo(() => (mission && live ? waitsOf(mission, live) : new Map<string, string[]>()), [mission, live]);
  const lives = useMemo(() => (mission ? withWaiting(livesOf(mission, control?.at ?? []), waits) : new Map<string, Life>()), [mission, control, waits]);
  const requests = useRequests(mission, control);
  const breakpoints = useMemo(() => (control ? breakpointsAfter(requests.asked, control) : []), [requests.asked, control]);
  const breaks = (path: string) => requests.ask({ what: 'break', at: withToggled(breakpoints, path) });
  return { isHeard: shown !== undefined, mission, control, live, lives, waits, requests, breakpoints, breaks };
}
type Current = ReturnType<typeof useMission>;

/** The plan of the mission, with which of its containers are open, and the states that are followed. */
function usePlan(mission: Mission | null, { control, lives }: Current) {
  const plan = mission ? planOf(mission) : null;
  const [follows, setFollows] = useState(true);
  const followed = useMemo(() => (plan ? followedOf(plan, control?.at ?? [], lives) : []), [plan, control, lives]);
  const { open, setOpen, onCrowded } = useOpen(plan, follows ? followed : []);
  const states = useMemo(() => new Map(plan?.states.map((state) => [state.path, state]) ?? []), [plan]);
  const kinds = useMemo(() => new Map(plan?.states.map((state) => [state.path, state.kind]) ?? []), [plan]);
  const toggle = (path: string) => {
    const next = new Set(open);
    if (!next.delete(path)) next.add(path);
    setOpen(next);
  };
  return { plan, states, kinds, open, setOpen, onCrowded, toggle, follows, setFollows, followed };
}

/** The row that was clicked on and the one under the pointer; Escape forgets the latter, then the former. */
function useChoice(run: Run | null) {
  const [chosen, setChosen] = useState<Choice | null>(null);
  const [peeked, setPeeked] = useState<string | null>(null);
  const selected = useMemo(() => rowOf(run, chosen), [run, chosen]);
  const select = (index: number) => {
    const label = run?.rows[index]?.label;
    setChosen(label === undefined ? null : { row: label, path: stateOf(label) });
  };
  const choose = (path: string | null) => setChosen(path === null ? null : { path });
  const dismiss = () => (peeked === null ? setChosen(null) : setPeeked(null));
  return { path: chosen?.path ?? null, selected, select, choose, peeked, setPeeked, dismiss };
}
type Chosen = ReturnType<typeof useChoice>;

/** Escape, and "b" for the breakpoint of the state that is selected. */
function useKeys(state: PlanState | undefined, { control, requests, breaks }: Current, dismiss: () => void): void {
  useEffect(() => {
    const press = (event: KeyboardEvent) => {
      if (event.key === 'Escape') dismiss();
      if (event.key !== 'b' || isTyping(event) || event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
      if (state && state.path !== '' && control?.steps && requests.may) breaks(state.path);
    };
    window.addEventListener('keydown', press);
    return () => window.removeEventListener('keydown', press);
  });
}

/** A run that is shown in place of that of the robot. */
interface Recorded {
  run: Run;
  /** "recorded", "simulated", or how a past run ended. */
  what: string;
  /** The id of a past run. */
  past: number | null;
}

function RecordedName({ recorded, onBack }: { recorded: Recorded; onBack: () => void }) {
  return <><strong>{recorded.run.name}</strong><span className="badge ended">{recorded.past === null ? recorded.what : 'past run: ' + recorded.what}</span>{recorded.past !== null && recorded.run.began !== null && <a href={'#past/' + recorded.run.began}>The robot then</a>}<button type="button" onClick={onBack}>Back to the robot</button></>;
}

type Side = 'start' | 'runs' | null;

/** The buttons that open and close the pane at the left. */
function SideButtons({ side, mayStart, onSide }: { side: Side; mayStart: boolean; onSide: (side: Side) => void }) {
  const button = (own: 'start' | 'runs', text: string) => <button type="button" aria-expanded={side === own} onClick={() => onSide(side === own ? null : own)}>{text}</button>;
  return <>{mayStart && button('start', 'Start a mission')}{button('runs', 'Past runs')}</>;
}

function MissionName({ mission, hasPlan, current, onChoose }: { mission: Mission; hasPlan: boolean; current: Current; onChoose: (path: string | null) => void }) {
  return (
    <>
      <ActionButton type="button" className="name" title="Its own inputs and outputs" tip whyNot={hasPlan ? '' : 'the plan is not here yet'} onClick={() => onChoose('')}>{mission.mission}</ActionButton>
      <StateBadge mission={mission} />
      <Controls mission={mission} control={current.control} requests={current.requests} onSelect={onChoose} />
    </>
  );
}

/** The problems of the mission. */
function Banners({ mission, requests }: Current) {
  return (
    <>
      {requests.problem && (
        <p className="banner refusal">
          <span role="alert">{requests.problem}</span> <button type="button" className="small" onClick={requests.dismiss}>dismiss</button>
        </p>
      )}
      {mission?.error && <p className="banner" role="alert">{mission.error}</p>}
      {(mission?.dropped ?? 0) > 0 && <p className="banner">The first {mission?.dropped} things that happened are not kept any more.</p>}
    </>
  );
}

/** The panel of the state that is selected, or of a row of the chart that is no state of the plan. */
function SidePanel({ state, current, planned, run, chosen, known }: { state: PlanState | undefined; current: Current; planned: ReturnType<typeof usePlan>; run: Run | null; chosen: Chosen; known: KnownValues | null }) {
  const { mission, control, lives, waits, requests, breakpoints, breaks } = current;
  const { kinds, open, toggle } = planned;
  const { selected, select, choose } = chosen;
  const row = run?.rows[selected];
  if (!state || !mission) return !state && run && row ? <NodePanel run={run} row={row} index={selected} onSelect={select} /> : null;
  return (
    <StatePanel
      key={state.path} state={state} mission={mission} control={control} lives={lives} waits={lives.get(state.path) === 'waiting' ? waits.get(state.path) : undefined} kinds={kinds} requests={requests} breakpoints={breakpoints} onBreak={breaks}
      isOpen={open.has(state.path)} onToggle={toggle} known={known} onClose={() => choose(null)}
    >
      {run && row && (
        <>
          {row.label !== state.path && <p className="quiet">{row.label}</p>}
          <NodeFacts run={run} row={row} index={selected} onSelect={select} />
        </>
      )}
    </StatePanel>
  );
}

export function MissionsView() {
  const current = useMission();
  const { isHeard, mission, control, live, lives, waits, requests, breakpoints, breaks } = current;
  const { mayOperate } = useConnection();
  const [recorded, setRecorded] = useState<Recorded | null>(null);
  const [side, setSide] = useState<Side>(null), [problem, setProblem] = useState('');
  const run = recorded?.run ?? live;
  const planned = usePlan(recorded ? null : mission, current);
  const { plan, states, open, setOpen, toggle, follows, setFollows, followed, onCrowded } = planned;
  const chosen = useChoice(run);
  const { path, selected, select, choose, peeked, setPeeked, dismiss } = chosen;
  const state = path === null ? undefined : states.get(path);
  const valuesOf = useValues(mission, control, [state?.path, peeked].filter((one) => typeof one === 'string').filter((one) => states.has(one)));
  useKeys(state, current, dismiss);
  const show = (found: Run, what: string, past: number | null = null) => [setRecorded({ run: found, what, past }), choose(null)];
  return (
    <div className="view split missions">
      {side === 'start' && mayOperate && <StartMission onBegun={() => [setRecorded(null), setSide(null)]} onSimulated={(found) => show(found, 'simulated')} />}
      {side === 'runs' && <PastRuns mission={mission} chosen={recorded?.past ?? null} onOpen={(found, id, ended) => show(found, ended, id)} onLive={() => setRecorded(null)} />}
      <section className="main" aria-label="Missions">
        <div className="bar">
          {recorded && <RecordedName recorded={recorded} onBack={() => setRecorded(null)} />}
          {!recorded && mission && <MissionName mission={mission} hasPlan={plan !== null} current={current} onChoose={choose} />}
          <SideButtons side={side} mayStart={mayOperate} onSide={setSide} />
          <FileButton onRun={(found) => show(found, 'recorded')} onProblem={setProblem} />
          {problem && <span className="bad" role="alert">{problem}</span>}
        </div>
        {!recorded && <Banners {...current} />}
        {!run && isHeard && <NoMission mayStart={mayOperate} />}
        {plan && mission && (
          <States
            plan={plan} mission={mission} control={control} lives={lives} waits={waits} selected={path} onSelect={choose}
            breakpoints={breakpoints} mayBreak={requests.may} onBreak={breaks} open={open} onOpen={setOpen} onToggle={toggle}
            follows={follows} onFollows={setFollows} followed={followed} onCrowded={onCrowded}
            peeked={peeked} onPeek={setPeeked} valuesOf={valuesOf}
          />
        )}
        {!recorded && mission && !plan && <p className="quiet note">{planProblem(mission)}</p>}
        {run && plan && mission && <Splitter name="states" label="Height of the states" axis="y" sized="before" />}
        {run && <GanttChart run={run} selected={selected} onSelect={select} />}
      </section>
      <SidePanel state={state} current={current} planned={planned} run={run} chosen={chosen} known={state ? valuesOf(state.path) : null} />
    </div>
  );
}
