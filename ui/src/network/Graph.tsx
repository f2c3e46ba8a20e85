// SPDX-License-Identifier: Apache-2.0
import { ReactFlow, Background, Controls, ReactFlowProvider } from '@xyflow/react';
import '@xyflow/react/dist/style.css';
import { useCallback, useId, useMemo, useRef, type ReactNode } from 'react';
import { BoxActionsContext } from './BoxButtons';
import { BulkEdges } from './BulkEdges';
import { boxWidth, labelWidth, type GraphEdge, type GraphGroup, type GraphNode } from './drawn_graph';
import { nodeTypes } from './GraphBoxes';
import { GraphTip } from './GraphTip';
import { nodeWidth, type BoxTree } from './boxes';
import { edgeTypes } from './RoutedEdge';
import { useBoxActions } from './useBoxActions';
import { cornerOf, useCamera } from './useCamera';
import { useDrawnBoxes, useDrawnEdges } from './useDrawn';
import { useLayout } from './useLayout';
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
  /** Labels of edges tell what happens, and do not change: each is shown. Else they are shown where there is room. */
  needsLabels?: boolean;
  /** See useLayout(). */
  onCrowded?: () => boolean;
}

/** The boxes of all groups and nodes, in each other. */
function treeOf(groups: GraphGroup[], nodes: GraphNode[]): BoxTree[] {
  const inside = new Map<string | undefined, BoxTree[]>([[undefined, []], ...groups.map((group): [string, BoxTree[]] => [group.id, []])]);
  for (const group of groups) inside.get(group.group)?.push({ id: group.id, first: group.first, children: inside.get(group.id) });
  for (const node of nodes) inside.get(node.group)?.push({ id: node.id, first: node.first });
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

/** The layout of the graph, anew where its structure changes. */
function useGraphLayout({ groups, nodes, edges, needsLabels, selected, onCrowded }: Props) {
  const structure = JSON.stringify([
    groups.map((group) => [group.id, group.group]),
    nodes.map((node) => [node.id, node.group]),
    edges.map((edge) => [edge.id, needsLabels && edge.label]),
  ]);
  const input = () => {
    const widths = new Map(nodes.map((node) => [node.id, boxWidth(node)]));
    const planned = edges.map((edge) => ({ ...edge, labelWidth: needsLabels ? labelWidth(edge.label ?? '') : edge.room }));
    return { roots: treeOf(groups, nodes), edges: planned, needsLabels, widthOf: (id: string) => widths.get(id) ?? nodeWidth };
  };
  return useLayout({ structure, input, isHeld: selected !== null && selected !== undefined, onCrowded });
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
  const { layout, isBusy } = useGraphLayout(props);
  const { boxes, routes } = layout;
  const around = useMemo(() => new Map([...groups, ...nodes].map((one) => [one.id, one.group])), [groups, nodes]);
  const camera = useCamera({ layout, around, target, follow, selected, first: [...nodes, ...groups].find((one) => one.first && one.group === undefined)?.id });
  const tipId = useId();
  const drawn = useDrawnBoxes({ groups, nodes, selected, markKey, tipId, tipped: tip?.id ?? null, areActive: props.onToggle !== undefined }, boxes);
  const { single, bulk, labelled } = useDrawnEdges(edges, selected, layout);
  const { buttons, click, leave, press, enter, leaveNode, focus } = useBoxActions(props, camera.toggles);
  const { frame, begin, rest } = useMoves();
  const tipBox = tip ? boxes.get(tip.id) : undefined;
  const tipCorner = tip ? cornerOf(tip.id, boxes, around) : null;
  const pointer = { onNodeClick: click, onPaneClick: leave, onNodeMouseEnter: enter, onNodeMouseLeave: leaveNode };
  const keyboard = { onKeyDown: press, onFocus: focus, onBlur: leaveNode };
  return (
    <div ref={frame} className="graph" role="region" aria-label={label} aria-busy={isBusy}>
      <BoxActionsContext value={buttons}>
        <ReactFlow
          nodes={drawn} edges={single} nodeTypes={nodeTypes} edgeTypes={edgeTypes} {...pointer} {...keyboard}
          onMoveStart={begin} onMove={camera.onMove} onMoveEnd={rest}
          nodesConnectable={false} minZoom={0.05} onlyRenderVisibleElements={nodes.length > mostDrawn}
        >
          {bulk && <BulkEdges edges={edges} routes={routes} labels={labelled ? layout.labels : null} />}
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
