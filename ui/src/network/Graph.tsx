// SPDX-License-Identifier: Apache-2.0
import { ReactFlow, Background, Controls, ReactFlowProvider } from '@xyflow/react';
import '@xyflow/react/dist/style.css';
import { useCallback, useEffect, useId, useMemo, useRef, useState, type ReactNode } from 'react';
import { BoxActionsContext } from './BoxButtons';
import { BulkEdges } from './BulkEdges';
import type { GraphEdge, GraphGroup, GraphNode } from './drawn_graph';
import { nodeTypes } from './GraphBoxes';
import { GraphTip } from './GraphTip';
import { Layouter, noLayout, type BoxTree, type Layout } from './layout';
import { edgeTypes } from './RoutedEdge';
import { useBoxActions } from './useBoxActions';
import { cornerOf, useCamera } from './useCamera';
import { useDrawnBoxes, useDrawnEdges } from './useDrawn';
import './network.css';

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

/** Above, only what can be seen is in the page. */
const mostDrawn = 400;

/** A graph of tasks in their processes. It is laid out anew where its structure changes, not where values do. */
export function Graph(props: Props) {
  return (
    <ReactFlowProvider>
      <Flow {...props} />
    </ReactFlowProvider>
  );
}

/** Where boxes and edges are. Values that change do not move anything. */
function useLayout({ groups, nodes, edges }: Props): Layout {
  const [layout, setLayout] = useState<Layout>(noLayout);
  const layouter = useRef(new Layouter());
  const structure = JSON.stringify([
    groups.map((group) => [group.id, group.group]),
    nodes.map((node) => [node.id, node.group]),
    edges.map((edge) => edge.id),
  ]);
  useEffect(() => {
    let current = true;
    layouter.current.ask({ roots: treeOf(groups, nodes), edges }, (found) => current && setLayout(found));
    return () => {
      current = false;
    };
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [structure]);
  return layout;
}

/** While it moves the drawing is one picture; it is drawn anew, and sharp, where it comes to rest. */
function useMoves() {
  const frame = useRef<HTMLDivElement>(null);
  const begin = useCallback(() => frame.current?.classList.add('moves'), []);
  const rest = useCallback(() => frame.current?.classList.remove('moves'), []);
  return { frame, begin, rest };
}

function Flow(props: Props) {
  const { label, groups, nodes, edges, selected, target, follow, markKey, onPeek, tip } = props;
  const { boxes, routes } = useLayout(props);
  const around = useMemo(() => new Map([...groups, ...nodes].map((one) => [one.id, one.group])), [groups, nodes]);
  const camera = useCamera({ boxes, around, target, follow });
  const tipId = useId();
  const drawn = useDrawnBoxes({ groups, nodes, selected, markKey, tipId, tipped: tip?.id ?? null, areActive: props.onToggle !== undefined }, boxes);
  const { single, bulk, labelled } = useDrawnEdges(edges, selected, routes);
  const { buttons, click, leave, press, enter, leaveNode, focus } = useBoxActions(props, camera.toggles);
  const { frame, begin, rest } = useMoves();
  const tipBox = tip ? boxes.get(tip.id) : undefined;
  const tipCorner = tip ? cornerOf(tip.id, boxes, around) : null;
  const pointer = { onNodeClick: click, onPaneClick: leave, onNodeMouseEnter: enter, onNodeMouseLeave: leaveNode };
  const keyboard = { onKeyDown: press, onFocus: focus, onBlur: leaveNode };
  return (
    <div ref={frame} className="graph" role="region" aria-label={label}>
      <BoxActionsContext value={buttons}>
        <ReactFlow
          nodes={drawn} edges={single} nodeTypes={nodeTypes} edgeTypes={edgeTypes} {...pointer} {...keyboard}
          onMoveStart={begin} onMove={camera.onMove} onMoveEnd={rest}
          nodesConnectable={false} minZoom={0.05} onlyRenderVisibleElements={nodes.length > mostDrawn}
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
