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

/** A box; one with children is drawn around them. */
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
 * Size and ends of edges of a node for React Flow. Sizes that are given need not be measured: React Flow hides a node
 * until it has been measured, and misses that where nodes are replaced in between.
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
  /** Edges between nodes, or between their anchors that have an id. */
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

const layered = { 'elk.algorithm': 'layered', 'elk.direction': 'RIGHT' };
/** Distances with room for a label such as "×12, 68/s, 4.54 ms" between two boxes. */
const spacing = { 'elk.layered.spacing.nodeNodeBetweenLayers': '124', 'elk.layered.spacing.edgeNodeBetweenLayers': '16', 'elk.spacing.nodeNode': '30', 'elk.spacing.edgeNode': '14' };

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

/** Above, each box is laid out for itself, since all together they would take many seconds. */
export const mostRouted = 300;

interface Laid {
  node: ElkNode;
  x: number;
  y: number;
}

type Planned = LayoutInput['edges'][number];

/** The boxes around each box, outermost first, and itself. */
function pathsOf(boxes: BoxTree[], outer: string[] = [], found = new Map<string, string[]>()): Map<string, string[]> {
  for (const box of boxes) {
    const path = [...outer, box.id];
    found.set(box.id, path);
    pathsOf(box.children ?? [], path, found);
  }
  return found;
}

/** The edges directly in each box ('': the whole): those that are given, or edges between the boxes around their ends. */
export function liftedEdges(input: LayoutInput): Map<string, Planned[]> {
  const paths = pathsOf(input.roots);
  const found = new Map<string, Map<string, Planned>>();
  for (const edge of input.edges) {
    const [a, b] = [paths.get(edge.source) ?? [], paths.get(edge.target) ?? []];
    let level = 0;
    while (level + 1 < Math.min(a.length, b.length) && a[level] === b[level]) ++level;
    const [source, target] = [a[level], b[level]];
    if (source === undefined || target === undefined) continue;
    const own = source === edge.source && target === edge.target;
    if (source === target && !own) continue;
    const around = a[level - 1] ?? '';
    const there = found.get(around) ?? new Map<string, Planned>();
    found.set(around, there);
    const between = source + '\n' + target;
    if (own || !there.has(between)) there.set(between, own ? edge : { id: 'lifted\n' + between, source, target });
  }
  return new Map([...found].map(([around, there]) => [around, [...there.values()]]));
}

/** A straight line between two boxes, from side to side. */
function straight(source: Laid, target: Laid): Point[] {
  const [width, height] = [(one: Laid) => one.node.width ?? 0, (one: Laid) => one.node.height ?? 0];
  const forward = source.x + width(source) <= target.x;
  return [
    { x: source.x + (forward ? width(source) : 0), y: source.y + height(source) / 2 },
    { x: target.x + (forward ? 0 : width(target)), y: target.y + height(target) / 2 },
  ];
}

function eachNode(node: ElkNode, act: (node: ElkNode) => void): void {
  act(node);
  node.children?.forEach((child) => eachNode(child, act));
}

function graphOf(input: LayoutInput): ElkNode {
  const known = new Set(idsOf(input.roots));
  const children = input.roots.map((box) => nodeOf(box, input));
  const graph: ElkNode = { id: '', layoutOptions: { ...layered, ...spacing, 'elk.json.edgeCoords': 'ROOT' }, children };
  const ports = new Set<string>();
  eachNode(graph, (node) => node.ports?.forEach((port) => ports.add(port.id)));
  const endOf = (node: string, type: Anchor['type'], anchor: string | undefined) => {
    const port = portId(node, type, anchor ?? '');
    return ports.has(port) ? port : node;
  };
  const drawn = (edge: Planned) => ({
    id: edge.id, sources: [endOf(edge.source, 'source', edge.sourceAnchor)], targets: [endOf(edge.target, 'target', edge.targetAnchor)],
  });
  if (input.edges.length > mostRouted) {
    const lifted = liftedEdges(input);
    eachNode(graph, (node) => {
      if (!node.children) return;
      node.layoutOptions = { ...node.layoutOptions, ...layered };
      node.edges = lifted.get(node.id)?.map(drawn);
    });
  } else {
    graph.layoutOptions = { ...graph.layoutOptions, 'elk.hierarchyHandling': 'INCLUDE_CHILDREN' };
    graph.edges = input.edges.filter((edge) => known.has(edge.source) && known.has(edge.target)).map(drawn);
  }
  return graph;
}

/**
 * Places from left to right along the edges, and ways of the edges around them; computed in a worker. With
 * more than mostRouted edges, those between tasks in different boxes are straight lines.
 */
export async function layOut(input: LayoutInput): Promise<Layout> {
  elk ??= new ElkApi({ workerUrl });
  const done = await elk.layout(graphOf(input));
  const boxes = new Map<string, Box>();
  const routes = new Map<string, Point[]>();
  const laid = new Map<string, Laid>();
  const add = (node: ElkNode, x: number, y: number) => {
    laid.set(node.id, { node, x, y });
    if (node !== done) boxes.set(node.id, { x: node.x ?? 0, y: node.y ?? 0, width: node.width ?? 0, height: node.height ?? 0 });
    node.children?.forEach((child) => add(child, x + (child.x ?? 0), y + (child.y ?? 0)));
    for (const edge of node.edges ?? []) {
      const section = edge.sections?.[0];
      if (section) routes.set(edge.id, [section.startPoint, ...(section.bendPoints ?? []), section.endPoint]);
    }
  };
  add(done, 0, 0);
  for (const edge of input.edges) {
    const [source, target] = [laid.get(edge.source), laid.get(edge.target)];
    if (!routes.has(edge.id) && source && target) routes.set(edge.id, straight(source, target));
  }
  return { boxes, routes };
}

/** Lays out the newest of what it is given, one after another: what became old while it waited is left out, and never answered. */
export class Layouter {
  private busy = false;
  private waiting: { input: LayoutInput; take: (layout: Layout) => void } | null = null;

  constructor(private readonly compute: (input: LayoutInput) => Promise<Layout> = layOut) {}

  ask(input: LayoutInput, take: (layout: Layout) => void): void {
    this.waiting = { input, take };
    if (!this.busy) void this.run();
  }

  private async run(): Promise<void> {
    this.busy = true;
    for (let next = this.waiting; next; next = this.waiting) {
      this.waiting = null;
      const found = await this.compute(next.input);
      if (!this.waiting) next.take(found);
    }
    this.busy = false;
  }
}
