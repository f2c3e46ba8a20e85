// SPDX-License-Identifier: Apache-2.0
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

export interface LayoutInput {
  groups: { id: string; nodes: string[] }[];
  edges: { id: string; source: string; target: string }[];
}

let elk: Elk | null = null;

/** Places of nodes (in their group) and groups, from left to right along the edges; computed in a worker. */
export async function layOut(input: LayoutInput): Promise<Map<string, Box>> {
  elk ??= new ElkApi({ workerUrl });
  const known = new Set(input.groups.flatMap((group) => group.nodes));
  const graph: ElkNode = {
    id: 'root',
    layoutOptions: {
      'elk.algorithm': 'layered',
      'elk.direction': 'RIGHT',
      'elk.hierarchyHandling': 'INCLUDE_CHILDREN',
      'elk.layered.spacing.nodeNodeBetweenLayers': '84',
      'elk.spacing.nodeNode': '30',
    },
    children: input.groups.map((group) => ({
      id: group.id,
      layoutOptions: { 'elk.padding': '[top=38,left=18,bottom=18,right=18]' },
      children: group.nodes.map((id) => ({ id, width: nodeWidth, height: nodeHeight })),
    })),
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
