// SPDX-License-Identifier: Apache-2.0
import { Position } from '@xyflow/react';
import type { ELK as Elk, ElkNode } from 'elkjs/lib/elk-api';
import ElkApi from 'elkjs/lib/elk-api.js';
import workerUrl from 'elkjs/lib/elk-worker.min.js?url';
import type { Point } from './route';

export const nodeWidth = 184;
export const nodeHeight = 54;

export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** What has children is drawn around them. */
export interface BoxTree {
  id: string;
  children?: BoxTree[];
}

/** Where an edge begins or ends at a node: the middle of its left or right side, or `y` below its upper corner. */
export interface Anchor {
  type: 'source' | 'target';
  id?: string;
  y?: number;
}

/**
 * Size and ends of edges of a node for React Flow. What is said need not be measured: React Flow hides a node until it
 * has been measured, and misses that where nodes are replaced in between.
 */
export function geometry(width: number, height: number, anchors: Anchor[]) {
  return {
    width,
    height,
    measured: { width, height },
    handles: anchors.map((anchor) => ({
      id: anchor.id ?? null,
      type: anchor.type,
      position: anchor.type === 'target' ? Position.Left : Position.Right,
      x: anchor.type === 'target' ? 0 : width,
      y: anchor.y ?? height / 2,
      width: 0,
      height: 0,
    })),
  };
}

export interface LayoutInput {
  roots: BoxTree[];
  /** Between nodes, or between anchors with an id of nodes. */
  edges: { id: string; source: string; target: string; sourceAnchor?: string; targetAnchor?: string }[];
  /** nodeHeight unless given. */
  heightOf?: (id: string) => number;
  /** nodeWidth unless given. */
  widthOf?: (id: string) => number;
  /** Where edges begin and end at a node; where it has none they do so anywhere. */
  anchorsOf?: (id: string) => Anchor[];
}

export interface Layout {
  /** Each relative to the box around it. */
  boxes: Map<string, Box>;
  /** The points of edges from beginning to end, relative to the whole. */
  routes: Map<string, Point[]>;
}

export const noLayout: Layout = { boxes: new Map(), routes: new Map() };

let elk: Elk | null = null;

const spacing = { 'elk.layered.spacing.nodeNodeBetweenLayers': '84', 'elk.layered.spacing.edgeNodeBetweenLayers': '16', 'elk.spacing.nodeNode': '30', 'elk.spacing.edgeNode': '14' };

function portId(node: string, type: Anchor['type'], anchor: string): string {
  return [node, type, anchor].join('\n');
}

function nodeOf(box: BoxTree, input: LayoutInput): ElkNode {
  if (!box.children) {
    const height = input.heightOf?.(box.id) ?? nodeHeight;
    const anchors = input.anchorsOf?.(box.id) ?? [];
    const width = input.widthOf?.(box.id) ?? nodeWidth;
    const node: ElkNode = { id: box.id, width, height };
    if (anchors.length === 0) return node;
    return {
      ...node,
      layoutOptions: { 'elk.portConstraints': 'FIXED_POS' },
      ports: anchors.map((anchor) => ({
        id: portId(box.id, anchor.type, anchor.id ?? ''), x: anchor.type === 'target' ? 0 : width, y: anchor.y ?? height / 2, width: 0, height: 0,
        layoutOptions: { 'elk.port.side': anchor.type === 'target' ? 'WEST' : 'EAST' },
      })),
    };
  }
  return {
    id: box.id,
    layoutOptions: { ...spacing, 'elk.padding': '[top=38,left=18,bottom=18,right=18]' },
    children: box.children.map((child) => nodeOf(child, input)),
  };
}

function idsOf(boxes: BoxTree[]): string[] {
  return boxes.flatMap((box) => [box.id, ...idsOf(box.children ?? [])]);
}

/** Places from left to right along the edges, and ways of the edges around them; computed in a worker. */
export async function layOut(input: LayoutInput): Promise<Layout> {
  elk ??= new ElkApi({ workerUrl });
  const known = new Set(idsOf(input.roots));
  const children = input.roots.map((box) => nodeOf(box, input));
  const ports = new Set<string>();
  const addPorts = (node: ElkNode) => {
    node.ports?.forEach((port) => ports.add(port.id));
    node.children?.forEach(addPorts);
  };
  children.forEach(addPorts);
  const endOf = (node: string, type: Anchor['type'], anchor: string | undefined) => {
    const port = portId(node, type, anchor ?? '');
    return ports.has(port) ? port : node;
  };
  const graph: ElkNode = {
    id: 'root',
    layoutOptions: {
      'elk.algorithm': 'layered',
      'elk.direction': 'RIGHT',
      'elk.hierarchyHandling': 'INCLUDE_CHILDREN',
      'elk.json.edgeCoords': 'ROOT',
      ...spacing,
    },
    children,
    edges: input.edges
      .filter((edge) => known.has(edge.source) && known.has(edge.target))
      .map((edge) => ({
        id: edge.id, sources: [endOf(edge.source, 'source', edge.sourceAnchor)], targets: [endOf(edge.target, 'target', edge.targetAnchor)],
      })),
  };
  const done = await elk.layout(graph);
  const boxes = new Map<string, Box>();
  const routes = new Map<string, Point[]>();
  const add = (node: ElkNode) => {
    if (node !== done) boxes.set(node.id, { x: node.x ?? 0, y: node.y ?? 0, width: node.width ?? 0, height: node.height ?? 0 });
    node.children?.forEach(add);
    for (const edge of node.edges ?? []) {
      const section = edge.sections?.[0];
      if (section) routes.set(edge.id, [section.startPoint, ...(section.bendPoints ?? []), section.endPoint]);
    }
  };
  add(done);
  return { boxes, routes };
}
