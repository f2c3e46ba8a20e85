// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useState } from 'react';
import { Graph } from '../network/Graph';
import { useConnection, useDocument } from '../robot/hooks';
import { GanttChart } from './GanttChart';
import { livesOf, missionOf, planOf, planProblem, type Mission, type Plan } from './mission';
import { runOfFile, runOfMission, type Row, type Run } from './run';
import { idOf, isContainer, openAtFirst, pathOf, stateGraphOf } from './states';

const longestAsked = 5000;

function secondsText(value: number): string {
  return value.toFixed(value < 10 ? 2 : 1) + ' s';
}

/** Pause, resume and stop; a request that the mission has not followed yet is shown as such. */
function Controls({ mission }: { mission: Mission }) {
  const connection = useConnection();
  const [asked, setAsked] = useState<{ what: string; state: string } | null>(null);
  const [problem, setProblem] = useState('');
  const { state } = mission;
  useEffect(() => setAsked((before) => (before && before.state !== state ? null : before)), [state]);
  // Somebody else may have asked for the opposite before this browser saw what became of it.
  useEffect(() => {
    if (!asked) return;
    const timer = setTimeout(() => setAsked(null), longestAsked);
    return () => clearTimeout(timer);
  }, [asked]);
  if (connection.role !== 'operate' || state === 'ended') return null;
  const ask = (what: string) => {
    setAsked({ what, state });
    connection.call('mission', { what }).then(
      () => setProblem(''),
      (error: Error) => [setProblem(error.message), setAsked(null)],
    );
  };
  const busy = asked !== null || state === 'stopping';
  return (
    <>
      {state === 'paused'
        ? <button type="button" disabled={busy} onClick={() => ask('resume')}>Resume</button>
        : <button type="button" disabled={busy} onClick={() => ask('pause')}>Pause</button>}
      <button type="button" disabled={asked?.what === 'stop' || state === 'stopping'} onClick={() => ask('stop')}>Stop</button>
      {asked && <span className="quiet">asked to {asked.what} …</span>}
      {problem && <span className="bad" role="alert">{problem}</span>}
    </>
  );
}

function StateBadge({ mission }: { mission: Mission }) {
  const lost = mission.outcome === 'lost';
  const bad = lost || mission.outcome === 'aborted';
  const text = mission.state === 'ended' ? (lost ? 'killed or lost' : 'ended: ' + (mission.outcome ?? '')) : mission.state;
  const tone = mission.state === 'running' ? 'good' : mission.state !== 'ended' ? 'warn' : bad ? 'bad' : 'idle';
  return <span className={'badge tone-' + tone} role="status">{text}</span>;
}

function States({ plan, mission, selected, onSelect }: { plan: Plan; mission: Mission; selected: string | null; onSelect: (path: string | null) => void }) {
  const structure = JSON.stringify(plan.states.map((state) => state.path));
  const [open, setOpen] = useState(() => openAtFirst(plan));
  const [withFlows, setWithFlows] = useState(false);
  // eslint-disable-next-line react-hooks/exhaustive-deps
  useEffect(() => setOpen(openAtFirst(plan)), [structure]);
  const lives = useMemo(() => livesOf(mission), [mission]);
  const graph = useMemo(() => stateGraphOf(plan, lives, open, withFlows), [plan, lives, open, withFlows]);
  const containers = useMemo(() => new Set(plan.states.filter((state) => state.path !== '' && isContainer(state)).map((state) => state.path)), [plan]);
  const toggle = (id: string) => {
    const next = new Set(open);
    if (!next.delete(pathOf(id))) next.add(pathOf(id));
    setOpen(next);
  };
  const choose = (id: string | null) => {
    if (id !== null && containers.has(pathOf(id))) toggle(id);
    else onSelect(id === null ? null : pathOf(id));
  };
  return (
    <section className="states" aria-label="States">
      <div className="bar">
        <span className="quiet">{plan.states.length - 1 || 1} states{plan.complete ? '' : ' (more are not shown)'}</span>
        <label><input type="checkbox" checked={withFlows} onChange={(event) => setWithFlows(event.target.checked)} /> data flows</label>
        <button type="button" className="small" onClick={() => setOpen(containers)}>open all</button>
        <button type="button" className="small" onClick={() => setOpen(new Set())}>close all</button>
      </div>
      <Graph
        label="Graph of states" groups={graph.groups} nodes={graph.nodes} edges={graph.edges}
        selected={selected === null ? null : idOf(selected)} onSelect={choose} onToggle={toggle}
      />
    </section>
  );
}

function NodePanel({ run, row, index, onSelect }: { run: Run; row: Row; index: number; onSelect: (row: number) => void }) {
  const waitedBy = run.rows.flatMap((other, at) => (other.waits.some((wait) => wait.row === index) ? [at] : []));
  const bar = row.bars[row.bars.length - 1];
  const line = (at: number, text: string) => (
    <li key={at + text}>
      <button type="button" className="line" disabled={at < 0} onClick={() => onSelect(at)}>
        <span>{run.rows[at]?.label ?? 'nothing in this run'}</span>
        <span className="quiet">{text}{run.rows[at] ? ', ' + run.rows[at].status : ''}</span>
      </button>
    </li>
  );
  return (
    <aside className="panel" aria-label={'Node ' + row.label}>
      <header>
        <h2>{row.label}</h2>
        <button type="button" aria-label="Close" onClick={() => onSelect(-1)}>×</button>
      </header>
      <p>
        <strong>{row.status}</strong>
        {row.outcome && ': ' + row.outcome}
        {bar && ', from ' + secondsText(bar.from) + (bar.until === Infinity ? '' : ' to ' + secondsText(bar.until))}
        {row.critical && ', on the critical path ◆'}
        {row.ahead && ', ran ahead of its turn, and its result counts'}
      </p>
      {row.error && <p className="bad">{row.error}</p>}
      <h3>{row.status === 'waiting' ? 'Waits for' : 'Waited for'}</h3>
      {row.waits.length === 0 ? <p className="quiet">nothing that is known</p> : <ul className="plain">{row.waits.map((wait) => line(wait.row, wait.because))}</ul>}
      {waitedBy.length > 0 && (
        <>
          <h3>What waits or waited for it</h3>
          <ul className="plain">{waitedBy.slice(0, 50).map((at) => line(at, ''))}</ul>
        </>
      )}
      {row.bars.length > 1 && <p className="quiet">{row.bars.length} runs, of which {row.bars.filter((one) => one.discarded).length} were thrown away</p>}
    </aside>
  );
}

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

export function MissionsView() {
  const shown = useDocument('mission');
  const mission = useMemo(() => missionOf(shown?.value), [shown]);
  const live = useMemo(() => (mission ? runOfMission(mission) : null), [mission]);
  const [recorded, setRecorded] = useState<Run | null>(null);
  const [problem, setProblem] = useState('');
  const [chosen, setChosen] = useState<string | null>(null);
  const run = recorded ?? live;
  const plan = mission && !recorded ? planOf(mission) : null;
  const byLabel = useMemo(() => new Map(run?.rows.map((row, index) => [row.label, index]) ?? []), [run]);
  // Rows come and go; a node keeps its name.
  const selected = chosen === null ? -1 : (byLabel.get(chosen) ?? -1);
  const row = run?.rows[selected];
  const select = (index: number) => setChosen(run?.rows[index]?.label ?? null);

  useEffect(() => {
    const close = (event: KeyboardEvent) => event.key === 'Escape' && setChosen(null);
    window.addEventListener('keydown', close);
    return () => window.removeEventListener('keydown', close);
  }, []);

  return (
    <div className="view split">
      <section className="main" aria-label="Missions">
        <div className="bar">
          {recorded && <><strong>{recorded.name}</strong><span className="badge">recorded</span><button type="button" onClick={() => setRecorded(null)}>Back to the robot</button></>}
          {!recorded && mission && <><strong>{mission.mission}</strong><StateBadge mission={mission} /><Controls mission={mission} /><span className="quiet">by {mission.who}</span></>}
          <FileButton onRun={(found) => [setRecorded(found), setChosen(null)]} onProblem={setProblem} />
          {problem && <span className="bad" role="alert">{problem}</span>}
        </div>
        {!recorded && mission?.error && <p className="banner" role="alert">{mission.error}</p>}
        {!recorded && (mission?.dropped ?? 0) > 0 && <p className="banner">The first {mission?.dropped} things that happened are not kept any more.</p>}
        {!run && shown && <p className="empty">No mission has commanded the robot since its runtime began. Start one: segue mission run FILE</p>}
        {plan && mission && <States plan={plan} mission={mission} selected={chosen === null ? null : chosen.replace(/#\d+$/, '')} onSelect={setChosen} />}
        {!recorded && mission && !plan && (
          <p className="quiet note">{planProblem(mission)}</p>
        )}
        {run && <GanttChart run={run} selected={selected} onSelect={select} />}
      </section>
      {run && row && <NodePanel run={run} row={row} index={selected} onSelect={select} />}
    </div>
  );
}
