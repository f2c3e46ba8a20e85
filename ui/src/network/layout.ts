// SPDX-License-Identifier: Apache-2.0
import { Position } from '@xyflow/react';
import type { ELK as Elk, ElkNode } from 'elkjs/lib/elk-api';
import ElkApi from 'elkjs/lib/elk-api.js';
import workerUrl from 'elkjs/lib/elk-worker.min.js?url';

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
  edges: { id: string; source: string; target: string }[];
  /** nodeHeight unless given. */
  heightOf?: (id: string) => number;
  /** nodeWidth unless given. */
  widthOf?: (id: string) => number;
}

let elk: Elk | null = null;

const spacing = { 'elk.layered.spacing.nodeNodeBetweenLayers': '84', 'elk.spacing.nodeNode': '30' };

function nodeOf(box: BoxTree, input: LayoutInput): ElkNode {
  if (!box.children) return { id: box.id, width: input.widthOf?.(box.id) ?? nodeWidth, height: input.heightOf?.(box.id) ?? nodeHeight };
  return {
    id: box.id,
    layoutOptions: { ...spacing, 'elk.padding': '[top=38,left=18,bottom=18,right=18]' },
    children: box.children.map((child) => nodeOf(child, input)),
  };
}

function idsOf(boxes: BoxTree[]): string[] {
  return boxes.flatMap((box) => [box.id, ...idsOf(box.children ?? [])]);
}

/** Places, each relative to the box around it, from left to right along the edges; computed in a worker. */
export async function layOut(input: LayoutInput): Promise<Map<string, Box>> {
  elk ??= new ElkApi({ workerUrl });
  const known = new Set(idsOf(input.roots));
  const graph: ElkNode = {
    id: 'root',
    layoutOptions: {
      'elk.algorithm': 'layered',
      'elk.direction': 'RIGHT',
      'elk.hierarchyHandling': 'INCLUDE_CHILDREN',
      ...spacing,
    },
    children: input.roots.map((box) => nodeOf(box, input)),
    edges: input.edges
      .filter((edge) => known.has(edge.source) && known.has(edge.target))
      .map((edge) => ({ id: edge.id, sources: [edge.source], targets: [edge.target] })),
  };
  const done = await elk.layout(graph);
  const boxes = new Map<string, Box>();
  const add = (node: ElkNode) => {
    boxes.set(node.id, { x: node.x ?? 0, y: node.y ?? 0, width: node.width ?? 0, height: node.height ?? 0 });
    node.children?.forEach(add);
  };
  done.children?.forEach(add);
  return boxes;
}
