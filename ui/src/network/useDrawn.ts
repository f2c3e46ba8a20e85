// SPDX-License-Identifier: Apache-2.0
import { MarkerType, type Edge, type Node } from '@xyflow/react';
import { useCallback, useMemo, useRef } from 'react';
import type { BoxMark } from './BoxButtons';
import type { GraphEdge, GraphGroup, GraphNode } from './drawn_graph';
import { Keeper } from './keeper';
import { geometry, nodeHeight, type Box, type Layout } from './boxes';
import { labelPlace, type Point } from './route';

const marker = { type: MarkerType.ArrowClosed, width: 16, height: 16, markerUnits: 'userSpaceOnUse' };
/** More edges are one drawing, without the dots behind it, which would be drawn anew in each frame while it moves. */
const mostSingle = 40;
/** Of more edges only those of the selected task have labels, and are drawn one by one. */
const mostLabelled = 150;

const marked = (mark: BoxMark | undefined) => (mark?.on ? ', ' + mark.label : '');
const ends = [{ type: 'target' as const }, { type: 'source' as const }];

function groupBox(group: GraphGroup, box: Box, selected: boolean, focusable: boolean): Node {
  return {
    id: group.id, type: 'place', parentId: group.group, position: box, selectable: false, selected,
    data: { title: group.title, look: group.look ?? '', expanded: group.expanded, mark: group.mark },
    focusable, draggable: false, ariaLabel: group.title + marked(group.mark),
    ...geometry(box.width, box.height, ends),
  };
}

function nodeBox(node: GraphNode, box: Box, selected: boolean): Node {
  return {
    id: node.id, type: 'task', zIndex: 2, parentId: node.group, position: box, draggable: false, selected,
    data: { title: node.title, detail: node.detail, look: node.look, folded: node.folded, expanded: node.expanded, mark: node.mark },
    ariaLabel: node.title + ', ' + node.detail + marked(node.mark),
    ...geometry(box.width, nodeHeight, ends),
  };
}

interface Boxes {
  groups: GraphGroup[];
  nodes: GraphNode[];
  selected?: string | null;
  markKey?: string;
  tipId: string;
  /** The box that has a tip. */
  tipped: string | null;
  /** Something can be done at groups. */
  areActive: boolean;
}

/** Groups and nodes at their places. Those that have not changed stay the same objects, so that they are not drawn anew. */
export function useDrawnBoxes({ groups, nodes, selected, markKey, tipId, tipped, areActive }: Boxes, boxes: Layout['boxes']): Node[] {
  const kept = useRef(new Keeper<Node>());
  const partsOf = useCallback((one: GraphNode | GraphGroup) => [one.expanded, one.mark?.on, one.mark?.label, one.mark?.fixed, one.id === tipped, markKey], [tipped, markKey]);
  const attributesOf = useCallback(
    (one: GraphNode | GraphGroup) => ({
      ...(one.id === tipped && { 'aria-describedby': tipId }),
      ...(one.mark && !one.mark.fixed && { 'aria-keyshortcuts': markKey }),
    }),
    [tipped, tipId, markKey],
  );
  return useMemo(() => {
    const keeper = kept.current.begin();
    const placeOf = (one: GraphNode | GraphGroup) => (one.group === undefined || boxes.has(one.group) ? boxes.get(one.id) : undefined);
    const drawnGroups = groups.flatMap((group) => {
      const box = placeOf(group);
      if (!box) return [];
      const chosen = group.expanded !== undefined && group.id === selected;
      return [keeper.keep(group.id, [box, group.group, group.title, group.look, areActive, chosen, ...partsOf(group)], () => ({ ...groupBox(group, box, chosen, areActive), domAttributes: attributesOf(group) }))];
    });
    const drawnNodes = nodes.flatMap((node) => {
      const box = placeOf(node);
      if (!box) return [];
      const chosen = node.id === selected;
      return [keeper.keep(node.id, [box, node.group, node.title, node.detail, node.look, chosen, node.folded, ...partsOf(node)], () => ({ ...nodeBox(node, box, chosen), domAttributes: attributesOf(node) }))];
    });
    keeper.end();
    return [...drawnGroups, ...drawnNodes];
  }, [boxes, groups, nodes, selected, areActive, partsOf, attributesOf]);
}

function drawnEdge(edge: GraphEdge, route: Point[] | undefined, labelAt: Point | undefined): Edge {
  return {
    id: edge.id, type: 'routed', data: { route, labelAt }, source: edge.source, target: edge.target, label: labelAt && edge.label, zIndex: -1, interactionWidth: 0,
    className: 'edge ' + edge.look, markerEnd: marker, focusable: false, ariaLabel: edge.source + ' to ' + edge.target,
  };
}

/** The edges that are drawn one by one, with labels where there is room; of many edges those of the selected box; `bulk`: the others are one drawing, with labels where `labelled`. */
export function useDrawnEdges(edges: GraphEdge[], selected: string | null | undefined, { routes, labels }: Layout) {
  const kept = useRef(new Keeper<Edge>());
  const bulk = edges.length > mostSingle;
  const labelled = edges.length <= mostLabelled;
  const lit = bulk && !labelled ? selected : null;
  const single = useMemo(() => {
    const keeper = kept.current.begin();
    const chosen = bulk ? edges.filter((edge) => lit !== null && lit !== undefined && (edge.source === lit || edge.target === lit)) : edges;
    const drawn = chosen.filter((edge) => routes.has(edge.id)).map((edge) => { // others come with the next layout
      const route = routes.get(edge.id);
      const labelAt = labels.get(edge.id) ?? (!labelled && route ? labelPlace(route) : undefined);
      return keeper.keep(edge.id, [route, labelAt?.x, labelAt?.y, edge.label, edge.look], () => drawnEdge(edge, route, labelAt));
    });
    keeper.end();
    return drawn;
  }, [edges, routes, labels, bulk, labelled, lit]);
  return { single, bulk, labelled };
}
