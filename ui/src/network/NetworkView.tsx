// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useRef, useState } from 'react';
import type { ConnectionStatus, Status } from '../robot/types';
import { edgesOf, groupsOf, matching, rateOf, toneOf } from './graph';
import { Graph } from './Graph';
import { TaskPanel } from './TaskPanel';

/** Samples per second of each connection, between the last two statuses. */
function useRates(status: Status): Map<string, number> {
  const before = useRef<{ connections: Record<string, ConnectionStatus>; uptime: number } | null>(null);
  const [rates, setRates] = useState<Map<string, number>>(new Map());
  useEffect(() => {
    const last = before.current;
    if (last && status.uptime_s - last.uptime < 0.4 && status.uptime_s > last.uptime) return;
    if (last) {
      const found = new Map<string, number>();
      for (const [key, connection] of Object.entries(status.connections)) {
        const rate = rateOf(last.connections[key], connection, status.uptime_s - last.uptime);
        if (rate !== null) found.set(key, rate);
      }
      setRates(found);
    }
    before.current = { connections: status.connections, uptime: status.uptime_s };
  }, [status]);
  return rates;
}

function edgeLabel(status: Status, rates: Map<string, number>, keys: string[]): string {
  const rate = keys.reduce((sum, key) => sum + (rates.get(key) ?? 0), 0);
  const dropped = keys.reduce((sum, key) => sum + (status.connections[key]?.dropped ?? 0), 0);
  return [rate > 0 ? (rate < 10 ? rate.toFixed(1) : rate.toFixed(0)) + '/s' : '', dropped > 0 ? dropped + ' dropped' : '']
    .filter((part) => part !== '')
    .join(', ');
}

export function NetworkView({ status }: { status: Status }) {
  const [selected, setSelected] = useState<string | null>(null);
  const [target, setTarget] = useState<string | null>(null);
  const [words, setWords] = useState('');
  const rates = useRates(status);
  const found = useMemo(() => (words.trim() === '' ? null : new Set(matching(status, words))), [status, words]);
  const groups = useMemo(() => groupsOf(status), [status]);

  useEffect(() => {
    const close = (event: KeyboardEvent) => event.key === 'Escape' && setSelected(null);
    window.addEventListener('keydown', close);
    return () => window.removeEventListener('keydown', close);
  }, []);

  const nodes = groups.flatMap((group) =>
    group.tasks.map((task) => ({
      id: task.id,
      group: group.id,
      title: task.id,
      detail: task.state_name || task.state,
      look: 'tone-' + toneOf(task.state) + (found && !found.has(task.id) ? ' faint' : ''),
    })),
  );
  const edges = edgesOf(status).map((edge) => ({
    ...edge,
    label: edgeLabel(status, rates, edge.connections),
    look: edge.connections.some((key) => (status.connections[key]?.dropped ?? 0) > 0) ? 'warns' : '',
  }));

  return (
    <div className="view split">
      <section className="main" aria-label="Network">
        <div className="bar">
          <label className="search">
            <span className="hidden">Find tasks</span>
            <input
              type="search"
              placeholder="Find tasks ( / )"
              data-search
              value={words}
              onChange={(event) => setWords(event.target.value)}
              onKeyDown={(event) => {
                const first = matching(status, words)[0];
                if (event.key === 'Enter' && first) [setSelected(first), setTarget(first)];
              }}
            />
          </label>
          <span className="quiet">
            {found ? found.size + ' of ' : ''}
            {nodes.length} tasks, {Object.keys(status.connections).length} connections
          </span>
          {status.differences.length > 0 && <span className="badge warn">{status.differences.length} differences</span>}
        </div>
        {nodes.length === 0 ? (
          <p className="empty">No task is running. Choose a controller in Switch.</p>
        ) : (
          <Graph label="Graph of tasks" groups={groups} nodes={nodes} edges={edges} selected={selected} target={target} onSelect={setSelected} />
        )}
      </section>
      {selected && <TaskPanel key={selected} id={selected} status={status} onClose={() => setSelected(null)} />}
    </div>
  );
}
