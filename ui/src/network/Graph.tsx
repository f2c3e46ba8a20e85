// SPDX-License-Identifier: Apache-2.0
import { Handle, Position, ReactFlow, Background, Controls, MarkerType, useReactFlow, useStore, ReactFlowProvider, type Edge, type Node, type NodeProps } from '@xyflow/react';
import '@xyflow/react/dist/style.css';
import { useCallback, useEffect, useId, useMemo, useRef, useState, type FocusEvent, type KeyboardEvent, type ReactNode } from 'react';
import { BoxActionsContext, MarkButton, OpenButton, type BoxActions, type BoxMark } from './BoxButtons';
import { BulkEdges } from './BulkEdges';
import type { GraphEdge, GraphGroup, GraphNode } from './drawn_graph';
import { GraphTip } from './GraphTip';
import { Keeper } from './keeper';
import { geometry, Layouter, nodeHeight, nodeWidth, noLayout, type Box, type BoxTree, type Layout } from './layout';
import { edgeTypes } from './RoutedEdge';
import './network.css';

type Buttons = { expanded?: boolean; mark?: BoxMark };
type TaskNode = Node<{ title: string; detail: string; look: string; folded?: boolean } & Buttons, 'task'>;
type GroupNode = Node<{ title: string; look: string } & Buttons, 'place'>;

function TaskBox({ id, data, selected }: NodeProps<TaskNode>) {
  return (
    <div className={'task-box ' + data.look + (selected ? ' selected' : '') + (data.folded ? ' folded' : '')}>
      <Handle type="target" position={Position.Left} isConnectable={false} />
      <strong><OpenButton id={id} title={data.title} expanded={data.expanded} />{data.title}</strong>
      <span>{data.detail}</span>
      <MarkButton id={id} mark={data.mark} />
      <Handle type="source" position={Position.Right} isConnectable={false} />
    </div>
  );
}

function PlaceBox({ id, data, selected }: NodeProps<GroupNode>) {
  return (
    <div className={'place-box ' + data.look + (selected ? ' selected' : '')}>
      <Handle type="target" position={Position.Left} isConnectable={false} />
      <OpenButton id={id} title={data.title} expanded={data.expanded} />
      {data.title}
      <MarkButton id={id} mark={data.mark} />
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
  /** A click on a group, or on the button of what has `expanded`. */
  onToggle?: (id: string) => void;
  /** The button of a mark, or its key at a box that has the focus. */
  onMark?: (id: string) => void;
  markKey?: string;
  /** Moved into view whenever it changes, unless it can be seen and read already. */
  follow?: string | null;
  /** The pointer rests on a box or its tip, or it has the focus of the keyboard; null: on none. */
  onPeek?: (id: string | null) => void;
  /** The text beside a box. */
  tip?: { id: string; content: ReactNode } | null;
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
/** The least zoom at which a followed box counts as legible. */
const legible = 0.45;
const marker = { type: MarkerType.ArrowClosed, width: 16, height: 16 };
/** Above, only what can be seen is in the page. */
const mostDrawn = 400;
/** Above, all edges are one drawing, without the dots behind it, which would be drawn anew in each frame while it moves. */
const mostSingle = 40;
/** Above, only the edges of the selected task have labels and are drawn one by one. */
const mostLabelled = 150;

/** A graph of tasks in their processes. It is laid out anew where its structure changes, not where values do. */
export function Graph(props: Props) {
  return (
    <ReactFlowProvider>
      <Flow {...props} />
    </ReactFlowProvider>
  );
}

const marked = (mark: BoxMark | undefined) => (mark?.on ? ', ' + mark.label : '');

/** The upper left corner of a box in the graph: the sum of its place and those of the boxes around it. */
function cornerOf(id: string, boxes: Map<string, Box>, around: Map<string, string | undefined>): { x: number; y: number } | null {
  let corner = { x: 0, y: 0 };
  for (let at: string | undefined = id; at !== undefined; at = around.get(at)) {
    const box = boxes.get(at);
    if (!box) return null;
    corner = { x: corner.x + box.x, y: corner.y + box.y };
  }
  return corner;
}

function Flow({ label, groups, nodes, edges, selected, target, onSelect, onToggle, onMark, markKey, follow, onPeek, tip }: Props) {
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
  const now = useRef({ groups, onSelect, onToggle, onMark, markKey, onPeek, boxes, around, follow, width, height });
  now.current = { groups, onSelect, onToggle, onMark, markKey, onPeek, boxes, around, follow, width, height };

  useEffect(() => {
    let current = true;
    layouter.current.ask({ roots: treeOf(groups, nodes), edges }, (found) => current && setLayout(found));
    return () => {
      current = false;
    };
    // Values that change do not move anything.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [structure]);

  // The followed box is moved into view where it cannot be seen or read.
  const bring = useCallback(() => {
    const seen = now.current;
    const box = seen.boxes.get(seen.follow ?? '');
    const corner = box && seen.follow ? cornerOf(seen.follow, seen.boxes, seen.around) : null;
    if (!box || !corner) return;
    const { x, y, zoom } = flow.getViewport();
    const size = { width: Math.min(box.width, nodeWidth), height: Math.min(box.height, nodeHeight) };
    const [left, top] = [corner.x * zoom + x, corner.y * zoom + y];
    const inside = left >= 0 && top >= 0 && left + size.width * zoom <= seen.width && top + size.height * zoom <= seen.height;
    if (inside && zoom >= legible) return;
    moved.current = true;
    void flow.setCenter(corner.x + size.width / 2, corner.y + size.height / 2, { zoom: Math.max(zoom, legible), duration: 250 });
  }, [flow]);
  useEffect(bring, [follow, bring]);

  // Where nobody has moved the graph, all of it stays in view, whatever opens beside it.
  const fit = useCallback(() => {
    if (moved.current) bring();
    else void flow.fitView(fitting).then(bring);
  }, [flow, bring]);

  // A box that somebody opens or closes stays where it is; otherwise all of a new graph is shown.
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
    if (moved.current && boxes.has(now.current.follow ?? '')) bring();
    else void flow.fitView(fitting).then(bring);
    // The target has an effect of its own.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [boxes, flow, bring]);

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

  const tipId = useId();
  const tipped = tip?.id ?? null;
  const partsOf = useCallback((one: GraphNode | GraphGroup) => [one.expanded, one.mark?.on, one.mark?.label, one.mark?.fixed, one.id === tipped, markKey], [tipped, markKey]);
  const attributesOf = useCallback(
    (one: GraphNode | GraphGroup) => ({
      ...(one.id === tipped && { 'aria-describedby': tipId }),
      ...(one.mark && !one.mark.fixed && { 'aria-keyshortcuts': markKey }),
    }),
    [tipped, tipId, markKey],
  );
  const flowNodes = useMemo<Node[]>(() => {
    const placed: Node[] = [];
    const keeper = kept.current.nodes.begin();
    for (const group of groups) {
      const box = boxes.get(group.id);
      if (!box || (group.group !== undefined && !boxes.has(group.group))) continue;
      const chosen = group.expanded !== undefined && group.id === selected;
      placed.push(keeper.keep(group.id, [box, group.group, group.title, group.look, onToggle !== undefined, chosen, ...partsOf(group)], () => ({
        id: group.id, type: 'place', parentId: group.group, position: box, selectable: false, selected: chosen,
        data: { title: group.title, look: group.look ?? '', expanded: group.expanded, mark: group.mark },
        focusable: onToggle !== undefined, draggable: false, ariaLabel: group.title + marked(group.mark), domAttributes: attributesOf(group),
        ...geometry(box.width, box.height, [{ type: 'target' }, { type: 'source' }]),
      })));
    }
    for (const node of nodes) {
      const box = boxes.get(node.id);
      if (!box || (node.group !== undefined && !boxes.has(node.group))) continue;
      const chosen = node.id === selected;
      placed.push(keeper.keep(node.id, [box, node.group, node.title, node.detail, node.look, chosen, node.folded, ...partsOf(node)], () => ({
        id: node.id, type: 'task', zIndex: 2, parentId: node.group, position: box, draggable: false, selected: chosen,
        data: { title: node.title, detail: node.detail, look: node.look, folded: node.folded, expanded: node.expanded, mark: node.mark },
        ariaLabel: node.title + ', ' + node.detail + marked(node.mark), domAttributes: attributesOf(node),
        ...geometry(nodeWidth, nodeHeight, [{ type: 'target' }, { type: 'source' }]),
      })));
    }
    keeper.end();
    return placed;
  }, [boxes, groups, nodes, selected, onToggle, partsOf, attributesOf]);

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

  // These functions stay identical as long as the graph is shown: new ones would draw each task anew.
  const act = useCallback((id: string, toggles: boolean) => {
    if (!toggles) return now.current.onSelect?.(id);
    const corner = cornerOf(id, now.current.boxes, now.current.around);
    toggled.current = corner && { id, corner };
    now.current.onToggle?.(id);
  }, []);
  const click = useCallback(
    (_: unknown, node: Node) => act(node.id, node.data['expanded'] === undefined && (node.type !== 'task' || node.data['folded'] === true)),
    [act],
  );
  const buttons = useMemo<BoxActions>(() => ({ toggle: (id) => act(id, true), mark: (id) => now.current.onMark?.(id) }), [act]);
  const leave = useCallback(() => now.current.onSelect?.(null), []);
  // A box that was clicked on has the focus, too, but another one may be selected since.
  const reachedByKey = useRef<string | null>(null);
  const press = useCallback(
    (event: KeyboardEvent) => {
      const node = flow.getNode((event.target as HTMLElement).dataset['id'] ?? '');
      if (!node || event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
      const { expanded, mark } = node.data as Buttons;
      if (event.key === 'Enter') click(event, node);
      if ((event.key === 'ArrowRight' && expanded === false) || (event.key === 'ArrowLeft' && expanded === true)) act(node.id, true);
      if (event.key !== now.current.markKey || !mark || mark.fixed || reachedByKey.current !== node.id) return;
      event.stopPropagation(); // elsewhere the key may mean the selected box
      now.current.onMark?.(node.id);
    },
    [act, click, flow],
  );
  const enter = useCallback((_: unknown, node: Node) => now.current.onPeek?.(node.id), []);
  const leaveNode = useCallback(() => now.current.onPeek?.(null), []);
  const focus = useCallback((event: FocusEvent) => {
    const id = (event.target as HTMLElement).dataset['id'];
    reachedByKey.current = id !== undefined && event.target.matches(':focus-visible') ? id : null;
    if (reachedByKey.current !== null) now.current.onPeek?.(reachedByKey.current);
  }, []);
  // While it moves the drawing is one picture; it is drawn anew, and sharp, where it comes to rest.
  const frame = useRef<HTMLDivElement>(null);
  const begin = useCallback(() => frame.current?.classList.add('moves'), []);
  const move = useCallback((event: unknown) => {
    if (event) moved.current = true; // by somebody; a click only begins and ends
  }, []);
  const rest = useCallback(() => frame.current?.classList.remove('moves'), []);

  const tipBox = tip ? boxes.get(tip.id) : undefined;
  const tipCorner = tip ? cornerOf(tip.id, boxes, around) : null;

  return (
    <div ref={frame} className="graph" role="region" aria-label={label}>
      <BoxActionsContext value={buttons}>
        <ReactFlow
          nodes={flowNodes}
          edges={flowEdges}
          nodeTypes={nodeTypes}
          edgeTypes={edgeTypes}
          onNodeClick={click}
          onPaneClick={leave}
          onKeyDown={press}
          onNodeMouseEnter={enter}
          onNodeMouseLeave={leaveNode}
          onFocus={focus}
          onBlur={leaveNode}
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
      </BoxActionsContext>
      {tip && tipCorner && tipBox && (
        <GraphTip id={tipId} {...tipCorner} height={tipBox.height} frame={frame} onEnter={() => onPeek?.(tip.id)} onLeave={leaveNode}>
          {tip.content}
        </GraphTip>
      )}
    </div>
  );
}
