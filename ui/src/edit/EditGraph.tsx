// SPDX-License-Identifier: Apache-2.0
import { Background, Controls, Handle, MarkerType, Position, ReactFlow, ReactFlowProvider, useReactFlow, type Connection, type Edge, type Node, type NodeProps } from '@xyflow/react';
import '@xyflow/react/dist/style.css';
import { useEffect, useMemo, useState } from 'react';
import { geometry, layOut, nodeWidth, type Anchor, type Box } from '../network/layout';
import { portOf, taskOf } from '../robot/types';
import { portsOf, refusal, type EditedPort, type Models } from './models';
import type { NetworkText } from './text';

const headHeight = 41;
const portHeight = 18;
const footHeight = 3;

function portsOn(side: 'input' | 'output', ports: EditedPort[]) {
  return ports.filter((port) => port.direction === side);
}

function anchorsOf(ports: EditedPort[]): Anchor[] {
  return (['input', 'output'] as const).flatMap((side) =>
    portsOn(side, ports).map((port, index) => ({ id: port.name, type: side === 'input' ? ('target' as const) : ('source' as const), y: headHeight + portHeight * (index + 0.5) })),
  );
}

type TaskNode = Node<{ title: string; component: string; ports: EditedPort[]; known: boolean; fixed: boolean }, 'edited'>;

function TaskBox({ data, selected }: NodeProps<TaskNode>) {
  return (
    <div className={'task-box edited ' + (data.known ? 'tone-idle' : 'tone-warn') + (selected ? ' selected' : '')}>
      <strong>{data.title}</strong>
      <span>{data.component || 'no component'}</span>
      {(['input', 'output'] as const).map((direction) => (
        <div key={direction} className={'ports ' + direction} style={{ top: headHeight, lineHeight: portHeight + 'px' }}>
          {portsOn(direction, data.ports).map((port) => (
            <div key={port.name} className="port" style={{ height: portHeight }} title={[port.type, port.doc].filter(Boolean).join(': ')}>
              <Handle
                id={port.name} type={direction === 'input' ? 'target' : 'source'} position={direction === 'input' ? Position.Left : Position.Right}
                isConnectable={!data.fixed}
              />
              {port.name}
            </div>
          ))}
        </div>
      ))}
    </div>
  );
}

function PlaceBox({ data }: NodeProps<Node<{ title: string }>>) {
  return <div className="place-box">{data.title}</div>;
}

const nodeTypes = { edited: TaskBox, place: PlaceBox };

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

/** The network as it is edited, with the ports of its tasks, which are connected by drawing. */
export function EditGraph(props: Props) {
  return (
    <ReactFlowProvider>
      <Flow {...props} />
    </ReactFlowProvider>
  );
}

function Flow({ network, models, fixed, task, connection, onTask, onConnection, onConnect, onRemove }: Props) {
  const flow = useReactFlow();
  const [boxes, setBoxes] = useState<Map<string, Box>>(new Map());
  const ports = useMemo(() => new Map(network.tasks.map((one) => [one.id, portsOf(network, models, one.id)])), [network, models]);
  const places = useMemo(() => [...new Set(network.tasks.map((one) => one.place))].sort(), [network]);
  const edges = useMemo(
    () =>
      network.connections.flatMap((one, index) =>
        one ? [{ id: index + ': ' + one.from + ' -> ' + one.to, index, source: taskOf(one.from), target: taskOf(one.to), from: one.from, to: one.to }] : [],
      ),
    [network],
  );
  const heightOf = (id: string) => {
    const all = ports.get(id) ?? [];
    const inputs = portsOn('input', all).length;
    return headHeight + portHeight * Math.max(inputs, all.length - inputs) + footHeight;
  };
  const panel = task !== null; // beside the graph
  const structure = JSON.stringify([network.tasks.map((one) => [one.id, one.place, heightOf(one.id)]), edges.map((edge) => edge.id)]);

  useEffect(() => {
    let current = true;
    const roots = places.map((place) => ({ id: 'group:' + place, children: network.tasks.filter((one) => one.place === place).map((one) => ({ id: one.id })) }));
    void layOut({ roots, edges, heightOf }).then((found) => current && setBoxes(found));
    return () => {
      current = false;
    };
    // Other changes move nothing.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [structure]);
  useEffect(() => {
    const timer = setTimeout(() => void flow.fitView({ padding: 0.08, maxZoom: 1.1 }), 30);
    return () => clearTimeout(timer);
  }, [boxes, flow, panel]);

  const nodes: Node[] = [];
  for (const place of places) {
    const box = boxes.get('group:' + place);
    if (box) nodes.push({ id: 'group:' + place, type: 'place', position: box, data: { title: place || 'runtime' }, selectable: false, focusable: false, draggable: false, ...geometry(box.width, box.height, []) });
  }
  for (const one of network.tasks) {
    const box = boxes.get(one.id);
    if (!box || !boxes.has('group:' + one.place)) continue;
    nodes.push({
      id: one.id, type: 'edited', zIndex: 2, parentId: 'group:' + one.place, position: box, draggable: false, selected: one.id === task,
      data: { title: one.id, component: one.component, ports: ports.get(one.id) ?? [], known: models.has(one.component), fixed },
      ariaLabel: one.id + ', ' + one.component, ...geometry(nodeWidth, heightOf(one.id), anchorsOf(ports.get(one.id) ?? [])),
    });
  }
  const ends = (drawn: Connection | Edge) => [drawn.source + '.' + drawn.sourceHandle, drawn.target + '.' + drawn.targetHandle] as const;

  return (
    <div
      className="graph edit-graph" role="region" aria-label="Graph of the network"
      onKeyDown={(event) => {
        const id = (event.target as HTMLElement).dataset['id'];
        if (event.key === 'Enter' && id && boxes.has(id)) onTask(id);
        if (event.key === 'Delete' || event.key === 'Backspace') onRemove();
      }}
    >
      <ReactFlow
        nodes={nodes}
        edges={edges.map((edge) => ({
          id: edge.id, source: edge.source, target: edge.target, sourceHandle: portOf(edge.from), targetHandle: portOf(edge.to), selected: edge.index === connection,
          className: 'edge' + (edge.index === connection ? ' fate-comes' : ''), zIndex: 1, focusable: false, markerEnd: { type: MarkerType.ArrowClosed, width: 16, height: 16 },
        }))}
        nodeTypes={nodeTypes}
        nodesConnectable={!fixed}
        deleteKeyCode={null}
        isValidConnection={(drawn) => refusal(network, models, ...ends(drawn)) === null}
        onConnect={(drawn) => onConnect(...ends(drawn))}
        onNodeClick={(_, node) => node.type === 'edited' && onTask(node.id)}
        onEdgeClick={(_, edge) => onConnection(Number.parseInt(edge.id, 10))}
        onPaneClick={() => onTask(null)}
        minZoom={0.1}
      >
        <Background gap={22} size={1} />
        <Controls showInteractive={false} />
      </ReactFlow>
    </div>
  );
}
