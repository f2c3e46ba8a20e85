// SPDX-License-Identifier: Apache-2.0
import { Background, Controls, Handle, MarkerType, Position, ReactFlow, ReactFlowProvider, type Connection, type Edge, type Node, type NodeProps } from '@xyflow/react';
import '@xyflow/react/dist/style.css';
import { useMemo } from 'react';
import { geometry, nodeWidth, type Anchor, type BoxTree, type Layout } from '../network/boxes';
import { boxWidth, titleWidth } from '../network/drawn_graph';
import { edgeTypes } from '../network/RoutedEdge';
import { useCamera } from '../network/useCamera';
import { useLayout } from '../network/useLayout';

const headHeight = 41;
const smallHeadHeight = 23;
const smallWidth = 104;
const portHeight = 18;
const footHeight = 3;
/** About the width of a character of a port. */
const portStep = 7.4;
const widest = 260;
/** Behind groups are edges, behind edges nodes. */
const layers = { edge: 40, node: 50 };

export interface GraphPort {
  id: string;
  side: 'input' | 'output';
  label: string;
  title?: string;
}
export interface PortNode {
  id: string;
  group?: string;
  title: string;
  /** undefined: a small node. */
  detail?: string;
  look: string;
  ports: GraphPort[];
}
/** A box around nodes; groups come before those in them. Its ports are connected from outside. */
export interface PortGroup {
  id: string;
  group?: string;
  title: string;
  ports?: GraphPort[];
  /** The group can be selected, as nodes can. */
  isEdited?: boolean;
}
export interface PortEdge {
  id: string;
  source: string;
  sourcePort: string;
  target: string;
  targetPort: string;
  look?: string;
}
export interface End {
  node: string;
  port: string;
}

interface Props {
  label: string;
  groups: PortGroup[];
  nodes: PortNode[];
  edges: PortEdge[];
  selected: string | null;
  selectedEdge: string | null;
  fixed: boolean;
  canConnect: (from: End, to: End) => boolean;
  onSelect: (id: string | null) => void;
  onEdge: (id: string) => void;
  onConnect: (from: End, to: End) => void;
  onRemove: () => void;
}

const sides = ['input', 'output'] as const;
const portsOn = (side: 'input' | 'output', ports: GraphPort[]) => ports.filter((port) => port.side === side);

function anchorsOf(ports: GraphPort[], head: number): Anchor[] {
  return sides.flatMap((side) =>
    portsOn(side, ports).map((port, index) => ({ id: port.id, type: side === 'input' ? ('target' as const) : ('source' as const), y: head + portHeight * (index + 0.5) })),
  );
}
const headOf = (node: PortNode) => (node.detail === undefined ? smallHeadHeight : headHeight);
/** As wide as its title and its ports side by side need it. */
function widthOf(node: PortNode): number {
  if (node.detail === undefined) return Math.max(smallWidth, titleWidth(node.title));
  const longest = (side: GraphPort['side']) => Math.max(0, ...portsOn(side, node.ports).map((port) => port.label.length));
  return Math.max(boxWidth(node), Math.min(widest, portStep * (longest('input') + longest('output')) + 36));
}
function heightOf(node: PortNode): number {
  const inputs = portsOn('input', node.ports).length;
  return headOf(node) + portHeight * Math.max(inputs, node.ports.length - inputs) + footHeight;
}

function Ports({ ports, head, fixed }: { ports: GraphPort[]; head: number; fixed: boolean }) {
  return sides.map((side) => (
    <div key={side} className={'ports ' + side} style={{ top: head, lineHeight: portHeight + 'px' }}>
      {portsOn(side, ports).map((port) => (
        <div key={port.id} className="port" style={{ height: portHeight }} title={port.title}>
          <Handle id={port.id} type={side === 'input' ? 'target' : 'source'} position={side === 'input' ? Position.Left : Position.Right} isConnectable={!fixed} />
          {port.label}
        </div>
      ))}
    </div>
  ));
}

function NodeBox({ data, selected }: NodeProps<Node<{ node: PortNode; fixed: boolean }>>) {
  const { node, fixed } = data;
  return (
    <div className={'task-box edited ' + node.look + (selected ? ' selected' : '')}>
      <strong>{node.title}</strong>
      {node.detail !== undefined && <span>{node.detail}</span>}
      <Ports ports={node.ports} head={headOf(node)} fixed={fixed} />
    </div>
  );
}

function GroupBox({ data, selected }: NodeProps<Node<{ group: PortGroup; fixed: boolean }>>) {
  return (
    <div className={'place-box' + (selected ? ' selected' : '')}>
      {data.group.title}
      <Ports ports={data.group.ports ?? []} head={headHeight} fixed={data.fixed} />
    </div>
  );
}

const nodeTypes = { edited: NodeBox, place: GroupBox };

function treeOf(groups: PortGroup[], nodes: PortNode[], around: string | undefined): BoxTree[] {
  return [
    ...groups.filter((group) => group.group === around).map((group) => ({ id: group.id, children: treeOf(groups, nodes, group.id) })),
    ...nodes.filter((node) => node.group === around).map((node) => ({ id: node.id })),
  ];
}

/** A graph as it is edited: nodes with ports, which are connected by drawing, in groups. */
export function PortGraph(props: Props) {
  return (
    <ReactFlowProvider>
      <Flow {...props} />
    </ReactFlowProvider>
  );
}

/** Where boxes and edges are; anew where the structure changes. */
function usePortLayout({ groups, nodes, edges, selected, selectedEdge }: Props): { layout: Layout; isBusy: boolean } {
  const structure = JSON.stringify([groups.map((group) => [group.id, group.group]), nodes.map((node) => [node.id, node.group, widthOf(node), anchorsOf(node.ports, headOf(node))]), edges.map((edge) => [edge.id, edge.source, edge.target])]);
  const input = () => {
    const known = new Map(nodes.map((node) => [node.id, { width: widthOf(node), height: heightOf(node), anchors: anchorsOf(node.ports, headOf(node)) }]));
    const longest = Math.max(0, ...groups.flatMap((group) => (group.ports ?? []).map((port) => port.label.length)));
    return {
      roots: treeOf(groups, nodes, undefined),
      distance: 44 + portStep * longest, // the ports of groups stand beside them
      edges: edges.map((edge) => ({ ...edge, sourceAnchor: edge.sourcePort, targetAnchor: edge.targetPort })),
      heightOf: (id: string) => known.get(id)?.height ?? headHeight,
      widthOf: (id: string) => known.get(id)?.width ?? nodeWidth,
      anchorsOf: (id: string) => known.get(id)?.anchors ?? [],
    };
  };
  return useLayout({ structure, input, isHeld: selected !== null || selectedEdge !== null });
}

/** Groups and nodes at their places; those whose group has none come with the next layout. */
function placedNodes({ groups, nodes, selected, fixed }: Props, boxes: Layout['boxes']): Node[] {
  const placed: Node[] = [];
  const known = new Set<string | undefined>([undefined]);
  for (const group of groups) {
    const box = boxes.get(group.id);
    if (!box || !known.has(group.group)) continue;
    known.add(group.id);
    placed.push({
      id: group.id, type: 'place', parentId: group.group, position: box, data: { group, fixed }, selectable: group.isEdited ?? false, focusable: group.isEdited ?? false, draggable: false,
      selected: group.id === selected, ariaLabel: group.title, ...geometry(box.width, box.height, anchorsOf(group.ports ?? [], headHeight)),
    });
  }
  for (const node of nodes) {
    const box = boxes.get(node.id);
    if (!box || !known.has(node.group)) continue;
    placed.push({
      id: node.id, type: 'edited', zIndex: layers.node, parentId: node.group, position: box, draggable: false, selected: node.id === selected, data: { node, fixed },
      ariaLabel: node.title + (node.detail ? ', ' + node.detail : ''), ...geometry(widthOf(node), heightOf(node), anchorsOf(node.ports, headOf(node))),
    });
  }
  return placed;
}

/** The edges between what is placed. The layout knows no ports of groups, so only edges between nodes have a route. */
function placedEdges({ nodes, edges, selectedEdge }: Props, placed: Node[], routes: Layout['routes']): Edge[] {
  const known = new Set(placed.map((one) => one.id));
  const isNode = new Set(nodes.map((node) => node.id));
  const routeOf = (edge: PortEdge) => (isNode.has(edge.source) && isNode.has(edge.target) ? routes.get(edge.id) : undefined);
  return edges.filter((edge) => known.has(edge.source) && known.has(edge.target)).map((edge) => ({
    id: edge.id, type: 'routed', data: { route: routeOf(edge) }, source: edge.source, target: edge.target, sourceHandle: edge.sourcePort, targetHandle: edge.targetPort, selected: edge.id === selectedEdge,
    className: 'edge ' + (edge.look ?? '') + (edge.id === selectedEdge ? ' fate-added' : ''), zIndex: layers.edge, focusable: false, markerEnd: { type: MarkerType.ArrowClosed, width: 16, height: 16 },
  }));
}

const endsOf = (drawn: Connection | Edge) => [{ node: drawn.source, port: drawn.sourceHandle ?? '' }, { node: drawn.target, port: drawn.targetHandle ?? '' }] as const;

function Flow(props: Props) {
  const { label, groups, nodes, fixed, canConnect, onSelect, onEdge, onConnect, onRemove } = props;
  const { layout, isBusy } = usePortLayout(props);
  const around = useMemo(() => new Map([...groups, ...nodes].map((one) => [one.id, one.group])), [groups, nodes]);
  const camera = useCamera({ layout, around, target: null, follow: null, selected: props.selected, first: nodes.find((node) => node.group === undefined)?.id });
  const placed = placedNodes(props, layout.boxes);
  const isEdited = (id: string) => nodes.some((node) => node.id === id) || groups.some((group) => group.id === id && group.isEdited);
  return (
    <div
      className="graph edit-graph" role="region" aria-label={label} aria-busy={isBusy}
      onKeyDown={(event) => {
        const id = (event.target as HTMLElement).dataset['id'];
        if (event.key === 'Enter' && id && isEdited(id)) onSelect(id);
        if (event.key === 'Delete' || event.key === 'Backspace') onRemove();
      }}
    >
      <ReactFlow
        nodes={placed}
        edges={placedEdges(props, placed, layout.routes)}
        nodeTypes={nodeTypes}
        edgeTypes={edgeTypes}
        nodesConnectable={!fixed}
        deleteKeyCode={null}
        isValidConnection={(drawn) => canConnect(...endsOf(drawn))}
        onConnect={(drawn) => onConnect(...endsOf(drawn))}
        onNodeClick={(_, node) => onSelect(isEdited(node.id) ? node.id : null)}
        onEdgeClick={(_, edge) => onEdge(edge.id)}
        onPaneClick={() => onSelect(null)}
        onMove={camera.onMove}
        minZoom={0.1}
        onlyRenderVisibleElements={nodes.length > 200}
      >
        <Background gap={22} size={1} />
        <Controls showInteractive={false} />
      </ReactFlow>
    </div>
  );
}
