// SPDX-License-Identifier: Apache-2.0
import { useMemo } from 'react';
import { portOf, taskOf } from '../robot/types';
import { portsOf, refusal, type Models } from './models';
import { PortGraph, type End, type PortNode } from './PortGraph';
import type { NetworkText } from './text';

interface Props {
  network: NetworkText;
  models: Models;
  fixed: boolean;
  task: string | null;
  connection: number | null;
  onTask: (id: string | null) => void;
  onConnection: (index: number) => void;
  onConnect: (from: string, to: string) => void;
  onRemove: () => void;
}

const groupOf = (place: string) => 'group:' + place;
const port = (end: End) => end.node + '.' + end.port;

/** The network as it is edited, with the ports of its tasks. */
export function EditGraph({ network, models, fixed, task, connection, onTask, onConnection, onConnect, onRemove }: Props) {
  const groups = useMemo(() => [...new Set(network.tasks.map((one) => one.place))].sort().map((place) => ({ id: groupOf(place), title: place || 'runtime' })), [network]);
  const nodes = useMemo<PortNode[]>(
    () =>
      network.tasks.map((one) => ({
        id: one.id, group: groupOf(one.place), title: one.id, detail: one.component || 'no component', look: models.has(one.component) ? 'tone-idle' : 'tone-warn',
        ports: portsOf(network, models, one.id).map((each) => ({
          id: each.name, side: each.direction === 'input' ? 'input' : 'output', label: each.name, title: [each.type, each.doc].filter(Boolean).join(': '),
        })),
      })),
    [network, models],
  );
  const edges = useMemo(
    () =>
      network.connections.flatMap((one, index) =>
        one ? [{ id: index + ': ' + one.from + ' -> ' + one.to, index, source: taskOf(one.from), target: taskOf(one.to), sourcePort: portOf(one.from), targetPort: portOf(one.to) }] : [],
      ),
    [network],
  );
  return (
    <PortGraph
      label="Graph of the network" groups={groups} nodes={nodes} edges={edges} selected={task} selectedEdge={edges.find((edge) => edge.index === connection)?.id ?? null} fixed={fixed}
      canConnect={(from, to) => refusal(network, models, port(from), port(to)) === null} onSelect={onTask} onEdge={(id) => onConnection(Number.parseInt(id, 10))}
      onConnect={(from, to) => onConnect(port(from), port(to))} onRemove={onRemove}
    />
  );
}
