// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useRef, useState } from 'react';
import { restOfAddress } from '../address';
import type { ConnectionStatus, Status } from '../robot/types';
import { foldLevels, useFolding } from './folding';
import { Graph } from './Graph';
import { latencyOf, matching, rateOf, type Flow, type Flows } from './graph';
import { bundlesOf, edgesOf, foldedAround, mostOpen, pictureOf, sameStructure, structureOf, type Structure } from './places';
import { TaskPanel } from './TaskPanel';
import { Units } from './Units';

/** The flow through each connection between the last two statuses. */
function useFlows(status: Status): Flows {
  const before = useRef<{ connections: Record<string, ConnectionStatus>; uptime: number } | null>(null);
  const [flows, setFlows] = useState<Flows>(new Map());
  useEffect(() => {
    const last = before.current;
    if (last && status.uptime_s - last.uptime < 0.4 && status.uptime_s > last.uptime) return;
    if (last) {
      const found = new Map<string, Flow>();
      for (const [key, connection] of Object.entries(status.connections)) {
        const known = last.connections[key];
        found.set(key, { rate: rateOf(known, connection, status.uptime_s - last.uptime), latency: latencyOf(known, connection) });
      }
      setFlows(found);
    }
    before.current = { connections: status.connections, uptime: status.uptime_s };
  }, [status]);
  return flows;
}

/** The structure of the network; the object stays identical as long as no part comes or goes. */
function useStructure(status: Status): Structure {
  const last = useRef<{ status: Status; structure: Structure } | null>(null);
  if (!last.current || !sameStructure(last.current.status, status)) last.current = { status, structure: structureOf(status) };
  return last.current.structure;
}

/** Which places are folded: in large networks all but those that somebody has opened, in others as many as others can be read. */
function usePlaces(structure: Structure) {
  const levels = useMemo(() => foldLevels(structure.places.map(({ id, tasks }) => ({ id, size: tasks.length, isInner: !id.startsWith('host:') })), structure.placeOf.size > mostOpen), [structure]);
  const folding = useFolding(structure, levels);
  const around = (task: string) => {
    const place = structure.placeOf.get(task);
    return [place?.id, place?.inside].filter((id) => id !== undefined);
  };
  return {
    ...folding,
    around,
    setAll: (folded: boolean) => folding.set(folded, structure.places.map((place) => place.id)),
    /** Unfolds the places around a task, so that it can be seen. */
    reveal: (task: string) => {
      if (foldedAround(structure, task, folding.isFolded)) folding.set(false, around(task));
    },
  };
}

const counted = (count: number, what: string) => `${count} ${what}${count === 1 ? '' : 's'}`;

interface FinderProps {
  words: string;
  onWords: (words: string) => void;
  onEnter: () => void;
}

function Finder({ words, onWords, onEnter }: FinderProps) {
  return (
    <label className="search">
      <span className="hidden">Find tasks</span>
      <input
        type="search" placeholder="Find tasks ( / )" data-search value={words}
        onChange={(event) => onWords(event.target.value)} onKeyDown={(event) => event.key === 'Enter' && onEnter()}
      />
    </label>
  );
}

/** The task that is selected, until Escape, and the one that the graph moves to. */
function useSelected() {
  const [selected, setSelected] = useState<string | null>(null);
  const [target, setTarget] = useState<string | null>(null);
  useEffect(() => {
    const close = (event: KeyboardEvent) => event.key === 'Escape' && setSelected(null);
    window.addEventListener('keydown', close);
    return () => window.removeEventListener('keydown', close);
  }, []);
  const jump = (task: string) => [setSelected(task), setTarget(task)];
  return { selected, target, setSelected, jump };
}

/** Shows the task that the address names, once. */
function useTaskOfAddress(status: Status, show: (task: string) => void) {
  const shown = useRef(false);
  useEffect(() => {
    const task = restOfAddress(window.location.hash, 'network');
    if (!shown.current && status.tasks[task]) show(task);
    shown.current = true;
  });
}

export function NetworkView({ status }: { status: Status }) {
  const { selected, target, setSelected, jump } = useSelected();
  const [words, setWords] = useState('');
  const flows = useFlows(status);
  const found = useMemo(() => (words.trim() === '' ? null : new Set(matching(status, words))), [status, words]);
  const structure = useStructure(status);
  const total = structure.placeOf.size;
  const folding = usePlaces(structure);
  const { isFolded } = folding;
  const bundles = useMemo(() => bundlesOf(structure, isFolded), [structure, isFolded]);
  const { groups, nodes } = useMemo(() => pictureOf(status, structure, isFolded, found), [status, structure, isFolded, found]);
  const edges = useMemo(() => edgesOf(status, flows, bundles), [status, flows, bundles]);
  const show = (task: string) => [folding.reveal(task), jump(task)];
  useTaskOfAddress(status, show);
  const enter = () => {
    const first = matching(status, words)[0];
    if (first) show(first);
  };
  return (
    <div className="view split">
      <section className="main" aria-label="Network">
        <div className="bar">
          <Finder words={words} onWords={setWords} onEnter={enter} />
          <span className="quiet">{found ? found.size + ' of ' : ''}{counted(total, 'task')}, {counted(structure.wires.length, 'connection')}</span>
          {structure.places.length > 1 && (
            <>
              <button type="button" className="small" onClick={() => folding.setAll(true)}>fold all</button>
              <button type="button" className="small" onClick={() => folding.setAll(false)}>unfold all</button>
            </>
          )}
          <Units status={status} />
          {status.differences.length > 0 && <span className="badge warn">{status.differences.length} differences</span>}
        </div>
        {total === 0 ? (
          <p className="empty">
            No task is running; those that do are drawn here, with their connections. Choose a controller in <a href="#switch">Switch</a>, or run <code>segue switch CONTROLLER</code>.
          </p>
        ) : (
          <Graph label="Graph of tasks" groups={groups} nodes={nodes} edges={edges} selected={selected} target={target} onSelect={setSelected} onToggle={folding.toggle} onCrowded={() => folding.onCrowded(selected === null ? [] : folding.around(selected))} />
        )}
      </section>
      {selected && <TaskPanel key={selected} id={selected} status={status} flows={flows} onClose={() => setSelected(null)} />}
    </div>
  );
}
