// SPDX-License-Identifier: Apache-2.0
import { Handle, Position, ReactFlow, Background, Controls, MarkerType, useReactFlow, useStore, ReactFlowProvider, type Edge, type Node, type NodeProps } from '@xyflow/react';
import '@xyflow/react/dist/style.css';
import { useEffect, useMemo, useRef, useState } from 'react';
import { geometry, layOut, nodeHeight, nodeWidth, type Box, type BoxTree } from './layout';

export interface GraphNode {
  id: string;
  group?: string;
  title: string;
  detail: string;
  /** Which colours: a class of style.css. */
  look: string;
}
export interface GraphEdge {
  id: string;
  source: string;
  target: string;
  label?: string;
  look: string;
}
export interface GraphGroup {
  id: string;
  title: string;
  /** The group around it; groups come before those in them. */
  group?: string;
  look?: string;
}

type TaskNode = Node<{ title: string; detail: string; look: string }, 'task'>;
type GroupNode = Node<{ title: string; look: string }, 'place'>;

function TaskBox({ data, selected }: NodeProps<TaskNode>) {
  return (
    <div className={'task-box ' + data.look + (selected ? ' selected' : '')}>
      <Handle type="target" position={Position.Left} isConnectable={false} />
      <strong>{data.title}</strong>
      <span>{data.detail}</span>
      <Handle type="source" position={Position.Right} isConnectable={false} />
    </div>
  );
}

function PlaceBox({ data }: NodeProps<GroupNode>) {
  return (
    <div className={'place-box ' + data.look}>
      <Handle type="target" position={Position.Left} isConnectable={false} />
      {data.title}
      <Handle type="source" position={Position.Right} isConnectable={false} />
    </div>
  );
}

const nodeTypes = { task: TaskBox, place: PlaceBox };

interface Props {
  label: string;
  groups: GraphGroup[];
  nodes: GraphNode[];
  edges: GraphEdge[];
  selected?: string | null;
  /** Moved into view whenever it changes. */
  target?: string | null;
  onSelect?: (id: string | null) => void;
  /** A click on a group. */
  onToggle?: (id: string) => void;
}

/** Boxes of the groups and nodes in a group; undefined: those that are in none. */
function treeOf(groups: GraphGroup[], nodes: GraphNode[], around: string | undefined): BoxTree[] {
  return [
    ...groups.filter((group) => group.group === around).map((group) => ({ id: group.id, children: treeOf(groups, nodes, group.id) })),
    ...nodes.filter((node) => node.group === around).map((node) => ({ id: node.id })),
  ];
}

/** A graph of tasks in their processes. It is laid out anew where its structure changes, not where values do. */
export function Graph(props: Props) {
  return (
    <ReactFlowProvider>
      <Flow {...props} />
    </ReactFlowProvider>
  );
}

function Flow({ label, groups, nodes, edges, selected, target, onSelect, onToggle }: Props) {
  const [boxes, setBoxes] = useState<Map<string, Box>>(new Map());
  const flow = useReactFlow();
  const moved = useRef(false);
  const width = useStore((store) => store.width);
  const height = useStore((store) => store.height);
  const structure = JSON.stringify([
    groups.map((group) => [group.id, group.group]),
    nodes.map((node) => [node.id, node.group]),
    edges.map((edge) => edge.id),
  ]);

  useEffect(() => {
    let current = true;
    void layOut({ roots: treeOf(groups, nodes, undefined), edges }).then((found) => {
      if (current) setBoxes(found);
    });
    return () => {
      current = false;
    };
    // Values that change do not move anything.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [structure]);

  useEffect(() => {
    const timer = setTimeout(() => void flow.fitView({ padding: 0.08, maxZoom: 1.15 }), 30);
    return () => clearTimeout(timer);
  }, [boxes, flow]);

  // Where nobody has moved the graph, all of it stays in view, whatever opens beside it.
  useEffect(() => {
    if (!moved.current) void flow.fitView({ padding: 0.08, maxZoom: 1.15 });
  }, [width, height, flow]);

  useEffect(() => {
    if (target && boxes.has(target)) void flow.fitView({ nodes: [{ id: target }], duration: 250, maxZoom: flow.getZoom() });
  }, [target, boxes, flow]);

  const flowNodes = useMemo<Node[]>(() => {
    const placed: Node[] = [];
    for (const group of groups) {
      const box = boxes.get(group.id);
      if (!box) continue;
      placed.push({
        id: group.id, type: 'place', parentId: group.group, position: box, data: { title: group.title, look: group.look ?? '' }, selectable: false,
        focusable: onToggle !== undefined, draggable: false, ariaLabel: group.title,
        ...geometry(box.width, box.height, [{ type: 'target' }]),
      });
    }
    for (const node of nodes) {
      const box = boxes.get(node.id);
      if (!box || (node.group !== undefined && !boxes.has(node.group))) continue;
      placed.push({
        id: node.id, type: 'task', zIndex: 2, parentId: node.group, position: box, draggable: false, selected: node.id === selected,
        data: { title: node.title, detail: node.detail, look: node.look }, ariaLabel: node.title + ', ' + node.detail,
        ...geometry(nodeWidth, nodeHeight, [{ type: 'target' }, { type: 'source' }]),
      });
    }
    return placed;
  }, [boxes, groups, nodes, selected, onToggle]);

  const flowEdges = useMemo<Edge[]>(
    () =>
      edges.map((edge) => ({
        id: edge.id, source: edge.source, target: edge.target, label: edge.label, zIndex: -1, interactionWidth: 0, className: 'edge ' + edge.look,
        markerEnd: { type: MarkerType.ArrowClosed, width: 16, height: 16 }, focusable: false,
        ariaLabel: edge.source + ' to ' + edge.target,
      })),
    [edges],
  );

  return (
    <div className="graph" role="region" aria-label={label}>
      <ReactFlow
        nodes={flowNodes}
        edges={flowEdges}
        nodeTypes={nodeTypes}
        onNodeClick={(_, node) => (node.type === 'task' ? onSelect?.(node.id) : onToggle?.(node.id))}
        onPaneClick={() => onSelect?.(null)}
        onKeyDown={(event) => {
          const id = (event.target as HTMLElement).dataset['id'];
          if (event.key !== 'Enter' || !id || !boxes.has(id)) return;
          if (groups.some((group) => group.id === id)) onToggle?.(id);
          else onSelect?.(id);
        }}
        onMoveStart={(event) => {
          if (event) moved.current = true;
        }}
        nodesConnectable={false}
        minZoom={0.1}
        onlyRenderVisibleElements={nodes.length > 200}
        proOptions={{ hideAttribution: false }}
      >
        <Background gap={22} size={1} />
        <Controls showInteractive={false} />
      </ReactFlow>
    </div>
  );
}
