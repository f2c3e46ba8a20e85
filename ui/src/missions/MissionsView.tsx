// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useState } from 'react';
import { isTyping } from '../keys';
import { useDocument } from '../robot/hooks';
import { controlOf, withToggled } from './control';
import { Controls, StateBadge } from './Controls';
import { GanttChart } from './GanttChart';
import { livesOf, missionOf, planOf, planProblem, type Life } from './mission';
import { NodeFacts, NodePanel } from './NodePanel';
import { breakpointsAfter, useRequests } from './requests';
import { runOfFile, runOfMission, type Run } from './run';
import { StatePanel } from './StatePanel';
import { States, useOpen } from './States';
import { useValues } from './values';
import './missions.css';

function FileButton({ onRun, onProblem }: { onRun: (run: Run) => void; onProblem: (text: string) => void }) {
  const read = async (file: File | undefined) => {
    if (!file) return;
    try {
      onRun(runOfFile(await file.text()));
      onProblem('');
    } catch (error) {
      onProblem(file.name + ': ' + (error instanceof Error ? error.message : String(error)));
    }
  };
  return (
    <label className="file">
      Open a recorded run
      <input type="file" accept=".json,application/json" onChange={(event) => void read(event.target.files?.[0])} />
    </label>
  );
}

/** The state of which a row of the chart is one turn. */
const stateOf = (label: string): string => label.replace(/#\d+$/, '');

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

export function MissionsView() {
  const shown = useDocument('mission');
  const mission = useMemo(() => missionOf(shown?.value), [shown]);
  const control = useMemo(() => controlOf(mission), [mission]);
  const live = useMemo(() => (mission ? runOfMission(mission) : null), [mission]);
  const lives = useMemo(() => (mission ? livesOf(mission, control?.at ?? []) : new Map<string, Life>()), [mission, control]);
  const [recorded, setRecorded] = useState<Run | null>(null);
  const [problem, setProblem] = useState('');
  const [chosen, setChosen] = useState<Choice | null>(null);
  const [peeked, setPeeked] = useState<string | null>(null);
  const run = recorded ?? live;
  const plan = mission && !recorded ? planOf(mission) : null;
  const [open, setOpen] = useOpen(plan);
  const states = useMemo(() => new Map(plan?.states.map((state) => [state.path, state]) ?? []), [plan]);
  const kinds = useMemo(() => new Map(plan?.states.map((state) => [state.path, state.kind]) ?? []), [plan]);
  const state = chosen === null ? undefined : states.get(chosen.path);

  const selected = useMemo(() => rowOf(run, chosen), [run, chosen]);
  const row = run?.rows[selected];
  const select = (index: number) => {
    const label = run?.rows[index]?.label;
    setChosen(label === undefined ? null : { row: label, path: stateOf(label) });
  };
  const choose = (path: string | null) => setChosen(path === null ? null : { path });

  const requests = useRequests(mission, control);
  const breakpoints = useMemo(() => (control ? breakpointsAfter(requests.asked, control) : []), [requests.asked, control]);
  const breaks = (path: string) => requests.ask({ what: 'break', at: withToggled(breakpoints, path) });
  const wanted = [state?.path, peeked].flatMap((path) => (typeof path === 'string' && states.has(path) ? [path] : []));
  const valuesOf = useValues(mission, control, wanted);

  useEffect(() => {
    const press = (event: KeyboardEvent) => {
      if (event.key === 'Escape' && peeked === null) setChosen(null);
      if (event.key === 'Escape') setPeeked(null);
      if (event.key !== 'b' || isTyping(event) || event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
      if (state && state.path !== '' && control?.steps && requests.may) breaks(state.path);
    };
    window.addEventListener('keydown', press);
    return () => window.removeEventListener('keydown', press);
  });

  const toggle = (path: string) => {
    const next = new Set(open);
    if (!next.delete(path)) next.add(path);
    setOpen(next);
  };
  return (
    <div className="view split missions">
      <section className="main" aria-label="Missions">
        <div className="bar">
          {recorded && <><strong>{recorded.name}</strong><span className="badge">recorded</span><button type="button" onClick={() => setRecorded(null)}>Back to the robot</button></>}
          {!recorded && mission && (
            <>
              <button type="button" className="name" title="Its own inputs and outputs" disabled={!plan} onClick={() => choose('')}>{mission.mission}</button>
              <StateBadge mission={mission} />
              <Controls mission={mission} control={control} requests={requests} onSelect={choose} />
            </>
          )}
          <FileButton onRun={(found) => [setRecorded(found), setChosen(null)]} onProblem={setProblem} />
          {problem && <span className="bad" role="alert">{problem}</span>}
        </div>
        {!recorded && requests.problem && (
          <p className="banner refusal">
            <span role="alert">{requests.problem}</span> <button type="button" className="small" onClick={requests.dismiss}>dismiss</button>
          </p>
        )}
        {!recorded && mission?.error && <p className="banner" role="alert">{mission.error}</p>}
        {!recorded && (mission?.dropped ?? 0) > 0 && <p className="banner">The first {mission?.dropped} things that happened are not kept any more.</p>}
        {!run && shown && <p className="empty">No mission has commanded the robot since its runtime began. Start one: segue mission run FILE</p>}
        {plan && mission && (
          <States
            plan={plan} mission={mission} control={control} lives={lives} selected={chosen?.path ?? null} onSelect={choose}
            breakpoints={breakpoints} mayBreak={requests.may} onBreak={breaks} open={open} onOpen={setOpen} onToggle={toggle}
            peeked={peeked} onPeek={setPeeked} valuesOf={valuesOf}
          />
        )}
        {!recorded && mission && !plan && (
          <p className="quiet note">{planProblem(mission)}</p>
        )}
        {run && <GanttChart run={run} selected={selected} onSelect={select} />}
      </section>
      {state && mission && (
        <StatePanel
          key={state.path} state={state} mission={mission} control={control} lives={lives} kinds={kinds} requests={requests} breakpoints={breakpoints} onBreak={breaks}
          isOpen={open.has(state.path)} onToggle={toggle} known={valuesOf(state.path)} onClose={() => setChosen(null)}
        >
          {run && row && (
            <>
              {row.label !== state.path && <p className="quiet">{row.label}</p>}
              <NodeFacts run={run} row={row} index={selected} onSelect={select} />
            </>
          )}
        </StatePanel>
      )}
      {!state && run && row && <NodePanel run={run} row={row} index={selected} onSelect={select} />}
    </div>
  );
}
