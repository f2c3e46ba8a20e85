// SPDX-License-Identifier: Apache-2.0
// How a graph is put to the layout library (ELK, algorithm "layered").
import type { ElkExtendedEdge, ElkNode, LayoutOptions } from 'elkjs/lib/elk-api';
import { nodeHeight, nodeWidth, type Anchor, type BoxTree, type LayoutInput } from './boxes';

/** One of the ways to lay out a graph, of which the most legible one is chosen. */
export interface Style {
  direction: 'RIGHT' | 'DOWN';
  /** Rows of layers as in a text, in place of one long row. */
  wraps: boolean;
  /** Room is kept for labels of edges. */
  labels: boolean;
}

/** Above, each box is laid out for itself, since all together they would take many seconds. */
export const mostRouted = 300;

/** Boxes that are not drawn: around what is connected, and around what is connected with nothing. */
const hidden = 'hidden\n';
export const isHidden = (node: ElkNode) => node.id.startsWith(hidden);

export const labelHeight = 18;
const between = { label: 18, bare: 44 };
/** Fewer boxes without edges need not be packed. */
const leastPacked = 3;

type Planned = LayoutInput['edges'][number];

const eachBox = (boxes: BoxTree[], act: (box: BoxTree, inside: BoxTree[]) => void, inside: BoxTree[] = []): void =>
  boxes.forEach((box) => [act(box, inside), eachBox(box.children ?? [], act, [...inside, box])]);

/** The boxes around each box, outermost first, and itself. */
function pathsOf(roots: BoxTree[]): Map<string, string[]> {
  const found = new Map<string, string[]>();
  eachBox(roots, (box, inside) => found.set(box.id, [...inside.map((one) => one.id), box.id]));
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
    const pair = source + '\n' + target;
    if (own || !there.has(pair)) there.set(pair, own ? edge : { id: 'lifted\n' + pair, source, target });
  }
  return new Map([...found].map(([around, there]) => [around, [...there.values()]]));
}

/** Boxes that are connected with each other, directly or by what is in them. */
function connectedRoots(roots: BoxTree[], edges: Planned[], paths: Map<string, string[]>): BoxTree[][] {
  const leader = new Map(roots.map((root) => [root.id, root.id]));
  const leaderOf = (id: string): string => {
    const next = leader.get(id) ?? id;
    return next === id ? id : leaderOf(next);
  };
  for (const { source, target } of edges) leader.set(leaderOf(paths.get(source)?.[0] ?? ''), leaderOf(paths.get(target)?.[0] ?? ''));
  const found = new Map<string, BoxTree[]>();
  for (const root of roots) found.set(leaderOf(root.id), [...(found.get(leaderOf(root.id)) ?? []), root]);
  return [...found.values()];
}

/** The boxes from the first ones on along the edges, so that edges that go back are seen as such; others keep their order. */
function inOrder(boxes: BoxTree[], edges: Planned[]): BoxTree[] {
  if (!boxes.some((box) => box.first)) return boxes;
  const byId = new Map(boxes.map((box) => [box.id, box]));
  const ordered = new Set<BoxTree>();
  const visit = (box: BoxTree | undefined): void => {
    if (!box || ordered.has(box)) return;
    ordered.add(box);
    for (const edge of edges) if (edge.source === box.id) visit(byId.get(edge.target));
  };
  [...boxes.filter((box) => box.first), ...boxes].forEach(visit);
  return [...ordered];
}

function portId(node: string, type: Anchor['type'], anchor: string): string {
  return [node, type, anchor].join('\n');
}

/** Builds the graph in one style. */
class Builder {
  private readonly paths: Map<string, string[]>;
  private readonly edges: Planned[];
  private readonly connected = new Set<string>();
  private readonly ports = new Set<string>();
  private hiddenBoxes = 0;

  constructor(private readonly input: LayoutInput, private readonly style: Style) {
    this.paths = pathsOf(input.roots);
    const known = input.edges.filter((edge) => this.paths.has(edge.source) && this.paths.has(edge.target));
    this.edges = known.length > mostRouted ? [...liftedEdges(input).values()].flat() : known;
    for (const { source, target } of this.edges) [this.connected.add(source), this.connected.add(target)];
  }

  whole(): ElkNode {
    const children = connectedRoots(this.input.roots, this.edges, this.paths).map((roots) => this.component(roots));
    const edges = this.edges.map((edge) => this.edge(edge));
    return { id: '', layoutOptions: { ...this.layered(false), 'elk.padding': '[top=0,left=0,bottom=0,right=0]', 'elk.json.edgeCoords': 'ROOT' }, children, edges };
  }

  private layered(wraps: boolean): LayoutOptions {
    const shape = this.input.shape;
    const distance = String(this.style.labels ? between.label : (this.input.distance ?? between.bare));
    return {
      'elk.algorithm': 'layered', 'elk.direction': this.style.direction, 'elk.aspectRatio': shape ? String(Math.max(0.2, shape.width / Math.max(1, shape.height))) : '1.6',
      'elk.layered.spacing.nodeNodeBetweenLayers': distance, 'elk.layered.spacing.edgeNodeBetweenLayers': '14', 'elk.spacing.nodeNode': '20', 'elk.spacing.edgeNode': '12',
      'elk.spacing.componentComponent': '24', ...(wraps && { 'elk.layered.wrapping.strategy': 'MULTI_EDGE' }),
      ...(this.input.roots.some((root) => root.first) && { 'elk.layered.cycleBreaking.strategy': 'MODEL_ORDER' }),
    };
  }

  private hide(children: ElkNode[], options: LayoutOptions): ElkNode {
    return { id: hidden + this.hiddenBoxes++, layoutOptions: { ...options, 'elk.padding': '[top=0,left=0,bottom=0,right=0]' }, children };
  }

  /** Connected boxes, laid out together where edges go into boxes, else box by box. */
  private component(roots: BoxTree[]): ElkNode {
    const inside = new Set<string>();
    eachBox(roots, (box) => inside.add(box.id));
    const parentOf = (id: string) => (this.paths.get(id) ?? []).slice(0, -1).pop();
    const crosses = this.edges.some((edge) => inside.has(edge.source) && parentOf(edge.source) !== parentOf(edge.target));
    const children = inOrder(roots, this.edges).map((box) => this.box(box, crosses));
    return this.hide(children, { ...this.layered(this.style.wraps), ...(crosses && { 'elk.hierarchyHandling': 'INCLUDE_CHILDREN' }) });
  }

  private box(box: BoxTree, crosses: boolean): ElkNode {
    if (!box.children) return this.leaf(box);
    const alone = box.children.filter((child) => crosses && !child.children && !this.connected.has(child.id));
    const packed = alone.length < leastPacked ? [] : alone;
    const children = inOrder(box.children.filter((child) => !packed.includes(child)), this.edges).map((child) => this.box(child, crosses));
    if (packed.length > 0) children.push(this.hide(packed.map((child) => this.leaf(child)), { ...this.layered(false), 'elk.hierarchyHandling': 'SEPARATE_CHILDREN' }));
    return { id: box.id, layoutOptions: { ...this.layered(this.style.wraps && !crosses), 'elk.padding': '[top=34,left=14,bottom=14,right=14]' }, children };
  }

  private leaf({ id }: BoxTree): ElkNode {
    const height = this.input.heightOf?.(id) ?? nodeHeight;
    const width = this.input.widthOf?.(id) ?? nodeWidth;
    const anchors = this.input.anchorsOf?.(id) ?? [];
    if (anchors.length === 0) return { id, width, height };
    const ports = anchors.map((anchor) => ({
      id: portId(id, anchor.type, anchor.id ?? ''), x: anchor.type === 'target' ? 0 : width, y: anchor.y ?? height / 2, width: 0, height: 0,
      layoutOptions: { 'elk.port.side': anchor.type === 'target' ? 'WEST' : 'EAST' },
    }));
    ports.forEach((port) => this.ports.add(port.id));
    return { id, width, height, layoutOptions: { 'elk.portConstraints': 'FIXED_POS' }, ports };
  }

  private edge(edge: Planned): ElkExtendedEdge {
    const endOf = (node: string, type: Anchor['type'], anchor: string | undefined) => {
      const port = portId(node, type, anchor ?? '');
      return this.ports.has(port) ? port : node;
    };
    const labels = this.style.labels && edge.labelWidth ? [{ id: 'label\n' + edge.id, text: ' ', width: edge.labelWidth, height: labelHeight }] : undefined;
    return { id: edge.id, sources: [endOf(edge.source, 'source', edge.sourceAnchor)], targets: [endOf(edge.target, 'target', edge.targetAnchor)], ...(labels && { labels }) };
  }
}

/** Whether edges begin or end at boxes with others in them. */
export function endsAtGroups(input: LayoutInput): boolean {
  const groups = new Set<string>();
  eachBox(input.roots, (box) => box.children && groups.add(box.id));
  return input.edges.some((edge) => groups.has(edge.source) || groups.has(edge.target));
}

export function elkGraph(input: LayoutInput, style: Style): ElkNode {
  return new Builder(input, style).whole();
}
