// SPDX-License-Identifier: Apache-2.0
import { Handle, Position, ReactFlow, Background, Controls, MarkerType, useReactFlow, useStore, ReactFlowProvider, type Edge, type Node, type NodeProps } from '@xyflow/react';
import '@xyflow/react/dist/style.css';
import { useCallback, useEffect, useMemo, useRef, useState, type KeyboardEvent } from 'react';
import { BulkEdges } from './BulkEdges';
import { Keeper } from './keeper';
import { geometry, Layouter, nodeHeight, nodeWidth, noLayout, type Box, type BoxTree, type Layout } from './layout';
import { edgeTypes } from './RoutedEdge';
import './network.css';

export interface GraphNode {
  id: string;
  group?: string;
  title: string;
  detail: string;
  /** Which colours: a class of style.css. */
  look: string;
  /** A group that is closed: a click opens it. */
  folded?: boolean;
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

type TaskNode = Node<{ title: string; detail: string; look: string; folded?: boolean }, 'task'>;
type GroupNode = Node<{ title: string; look: string }, 'place'>;

function TaskBox({ data, selected }: NodeProps<TaskNode>) {
  return (
    <div className={'task-box ' + data.look + (selected ? ' selected' : '') + (data.folded ? ' folded' : '')}>
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

/** The boxes of all groups and nodes, in each other. */
function treeOf(groups: GraphGroup[], nodes: GraphNode[]): BoxTree[] {
  const inside = new Map<string | undefined, BoxTree[]>([[undefined, []], ...groups.map((group): [string, BoxTree[]] => [group.id, []])]);
  for (const group of groups) inside.get(group.group)?.push({ id: group.id, children: inside.get(group.id) });
  for (const node of nodes) inside.get(node.group)?.push({ id: node.id });
  return inside.get(undefined) ?? [];
}

const fitting = { padding: 0.08, maxZoom: 1.15 };
const readable = 0.7;
const marker = { type: MarkerType.ArrowClosed, width: 16, height: 16 };
/** Above, only what can be seen is in the page. */
const mostDrawn = 400;
/** More edges are one drawing, without the dots behind it, which would be drawn anew in each frame while it moves. */
const mostSingle = 40;
/** Of more edges only those of the selected task have labels, and are drawn one by one. */
const mostLabelled = 150;

/** A graph of tasks in their processes. It is laid out anew where its structure changes, not where values do. */
export function Graph(props: Props) {
  return (
    <ReactFlowProvider>
      <Flow {...props} />
    </ReactFlowProvider>
  );
}

/** What is left of and above a box, with the boxes around it. */
function cornerOf(id: string, boxes: Map<string, Box>, around: Map<string, string | undefined>): { x: number; y: number } | null {
  let corner = { x: 0, y: 0 };
  for (let at: string | undefined = id; at !== undefined; at = around.get(at)) {
    const box = boxes.get(at);
    if (!box) return null;
    corner = { x: corner.x + box.x, y: corner.y + box.y };
  }
  return corner;
}

function Flow({ label, groups, nodes, edges, selected, target, onSelect, onToggle }: Props) {
  const [layout, setLayout] = useState<Layout>(noLayout);
  const { boxes, routes } = layout;
  const layouter = useRef(new Layouter());
  const flow = useReactFlow();
  const moved = useRef(false);
  const reached = useRef<string | null>(null);
  const kept = useRef({ nodes: new Keeper<Node>(), edges: new Keeper<Edge>() });
  const width = useStore((store) => store.width);
  const height = useStore((store) => store.height);
  const structure = JSON.stringify([
    groups.map((group) => [group.id, group.group]),
    nodes.map((node) => [node.id, node.group]),
    edges.map((edge) => edge.id),
  ]);
  const around = useMemo(() => new Map([...groups, ...nodes].map((one) => [one.id, one.group])), [groups, nodes]);
  const now = useRef({ groups, onSelect, onToggle, boxes, around });
  now.current = { groups, onSelect, onToggle, boxes, around };

  useEffect(() => {
    let current = true;
    layouter.current.ask({ roots: treeOf(groups, nodes), edges }, (found) => current && setLayout(found));
    return () => {
      current = false;
    };
    // Values that change do not move anything.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [structure]);

  // Where nobody has moved the graph, all of it stays in view, whatever opens beside it.
  const fit = useCallback(() => {
    if (!moved.current) void flow.fitView(fitting);
  }, [flow]);

  // What somebody opens or closes stays where it is; else all of a new graph is shown.
  const toggled = useRef<{ id: string; corner: { x: number; y: number } } | null>(null);
  useEffect(() => {
    const before = toggled.current;
    toggled.current = null;
    const corner = before && moved.current ? cornerOf(before.id, boxes, now.current.around) : null;
    if (before && corner) {
      const { x, y, zoom } = flow.getViewport();
      void flow.setViewport({ x: x + (before.corner.x - corner.x) * zoom, y: y + (before.corner.y - corner.y) * zoom, zoom });
      return;
    }
    if (target && reached.current !== target) return;
    void flow.fitView(fitting);
    // The target has an effect of its own.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [boxes, flow]);

  useEffect(fit, [width, height, fit]);

  useEffect(() => {
    if (!target) reached.current = null;
    if (!target || reached.current === target) return;
    const corner = cornerOf(target, boxes, now.current.around);
    if (!corner) return;
    reached.current = target;
    moved.current = true;
    const box = boxes.get(target);
    const zoom = Math.max(flow.getZoom(), readable);
    void flow.setCenter(corner.x + (box?.width ?? 0) / 2, corner.y + (box?.height ?? 0) / 2, { zoom, duration: 250 });
  }, [target, boxes, flow]);

  const flowNodes = useMemo<Node[]>(() => {
    const placed: Node[] = [];
    const keeper = kept.current.nodes.begin();
    for (const group of groups) {
      const box = boxes.get(group.id);
      if (!box || (group.group !== undefined && !boxes.has(group.group))) continue;
      placed.push(keeper.keep(group.id, [box, group.group, group.title, group.look, onToggle !== undefined], () => ({
        id: group.id, type: 'place', parentId: group.group, position: box, data: { title: group.title, look: group.look ?? '' }, selectable: false,
        focusable: onToggle !== undefined, draggable: false, ariaLabel: group.title,
        ...geometry(box.width, box.height, [{ type: 'target' }, { type: 'source' }]),
      })));
    }
    for (const node of nodes) {
      const box = boxes.get(node.id);
      if (!box || (node.group !== undefined && !boxes.has(node.group))) continue;
      const chosen = node.id === selected;
      placed.push(keeper.keep(node.id, [box, node.group, node.title, node.detail, node.look, chosen, node.folded], () => ({
        id: node.id, type: 'task', zIndex: 2, parentId: node.group, position: box, draggable: false, selected: chosen,
        data: { title: node.title, detail: node.detail, look: node.look, folded: node.folded }, ariaLabel: node.title + ', ' + node.detail,
        ...geometry(nodeWidth, nodeHeight, [{ type: 'target' }, { type: 'source' }]),
      })));
    }
    keeper.end();
    return placed;
  }, [boxes, groups, nodes, selected, onToggle]);

  const bulk = edges.length > mostSingle;
  const labelled = edges.length <= mostLabelled;
  const lit = bulk && !labelled ? selected : null;
  const flowEdges = useMemo<Edge[]>(() => {
    const keeper = kept.current.edges.begin();
    const single = bulk ? edges.filter((edge) => lit !== null && (edge.source === lit || edge.target === lit)) : edges;
    const drawn = single.filter((edge) => routes.has(edge.id)).map((edge) => { // others come with the next layout
      const route = routes.get(edge.id);
      return keeper.keep(edge.id, [route, edge.label, edge.look], () => ({
        id: edge.id, type: 'routed', data: { route }, source: edge.source, target: edge.target, label: edge.label, zIndex: -1, interactionWidth: 0,
        className: 'edge ' + edge.look, markerEnd: marker, focusable: false, ariaLabel: edge.source + ' to ' + edge.target,
      }));
    });
    keeper.end();
    return drawn;
  }, [edges, routes, bulk, lit]);

  // The same functions as long as the graph is shown: others would draw each task anew.
  const act = useCallback((id: string, toggles: boolean) => {
    if (!toggles) return now.current.onSelect?.(id);
    const corner = cornerOf(id, now.current.boxes, now.current.around);
    toggled.current = corner && { id, corner };
    now.current.onToggle?.(id);
  }, []);
  const click = useCallback((_: unknown, node: Node) => act(node.id, node.type !== 'task' || node.data['folded'] === true), [act]);
  const leave = useCallback(() => now.current.onSelect?.(null), []);
  const press = useCallback(
    (event: KeyboardEvent) => {
      const id = (event.target as HTMLElement).dataset['id'];
      const node = id === undefined ? undefined : flow.getNode(id);
      if (event.key === 'Enter' && node) click(event, node);
    },
    [click, flow],
  );
  // While it moves the drawing is one picture; it is drawn anew, and sharp, where it comes to rest.
  const frame = useRef<HTMLDivElement>(null);
  const begin = useCallback(() => frame.current?.classList.add('moves'), []);
  const move = useCallback((event: unknown) => {
    if (event) moved.current = true; // by somebody; a click only begins and ends
  }, []);
  const rest = useCallback(() => frame.current?.classList.remove('moves'), []);

  return (
    <div ref={frame} className="graph" role="region" aria-label={label}>
      <ReactFlow
        nodes={flowNodes}
        edges={flowEdges}
        nodeTypes={nodeTypes}
        edgeTypes={edgeTypes}
        onNodeClick={click}
        onPaneClick={leave}
        onKeyDown={press}
        onMoveStart={begin}
        onMove={move}
        onMoveEnd={rest}
        nodesConnectable={false}
        minZoom={0.05}
        onlyRenderVisibleElements={nodes.length > mostDrawn}
      >
        {bulk && <BulkEdges edges={edges} routes={routes} labelled={labelled} />}
        {!bulk && <Background gap={22} size={1} />}
        <Controls showInteractive={false} />
      </ReactFlow>
    </div>
  );
}
