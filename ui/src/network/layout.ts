// SPDX-License-Identifier: Apache-2.0
import type { ELK as Elk, ElkNode } from 'elkjs/lib/elk-api';
import ElkApi from 'elkjs/lib/elk-api.js';
import workerUrl from 'elkjs/lib/elk-worker.min.js?url';
import { fittingZoom, noLayout, readable, type BoxTree, type Layout, type LayoutInput } from './boxes';
import { elkGraph, endsAtGroups, isHidden, mostRouted, type Style } from './elk_graph';
import { placeLabels } from './labels';
import type { Point } from './route';

let elk: Elk | null = null;

interface Laid {
  node: ElkNode;
  x: number;
  y: number;
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

/** Whether a point is at the rim of a box, or in it. */
function touches({ node, x, y }: Laid, point: Point | undefined): boolean {
  const [width, height] = [node.width ?? 0, node.height ?? 0];
  return point !== undefined && point.x >= x - 1 && point.y >= y - 1 && point.x <= x + width + 1 && point.y <= y + height + 1;
}

/** A layout as it was computed; `broken` edges have no way, or a wrong one. */
interface Found {
  layout: Layout;
  laid: Map<string, Laid>;
  broken: number;
}

function foundIn(done: ElkNode, input: LayoutInput): Found {
  const layout: Layout = { boxes: new Map(), routes: new Map(), labels: new Map(), size: { width: done.width ?? 0, height: done.height ?? 0 } };
  const laid = new Map<string, Laid>();
  const add = (node: ElkNode, from: Point, at: Point) => {
    const isDrawn = node !== done && !isHidden(node);
    if (isDrawn) {
      laid.set(node.id, { node, ...at });
      layout.boxes.set(node.id, { x: at.x - from.x, y: at.y - from.y, width: node.width ?? 0, height: node.height ?? 0 });
    }
    node.children?.forEach((child) => add(child, isDrawn ? at : from, { x: at.x + (child.x ?? 0), y: at.y + (child.y ?? 0) }));
    for (const edge of node.edges ?? []) {
      const section = edge.sections?.[0];
      if (section) layout.routes.set(edge.id, [section.startPoint, ...(section.bendPoints ?? []), section.endPoint]);
      const label = edge.labels?.[0];
      if (label) layout.labels.set(edge.id, { x: (label.x ?? 0) + (label.width ?? 0) / 2, y: (label.y ?? 0) + (label.height ?? 0) / 2 });
    }
  };
  add(done, { x: 0, y: 0 }, { x: 0, y: 0 });
  let broken = 0;
  for (const edge of input.edges) {
    const [source, target, route] = [laid.get(edge.source), laid.get(edge.target), layout.routes.get(edge.id)];
    if (!source || !target || (route && touches(source, route[0]) && touches(target, route[route.length - 1]))) continue;
    ++broken;
    layout.labels.delete(edge.id);
    layout.routes.set(edge.id, straight(source, target));
  }
  return { layout, laid, broken };
}

/** Of more boxes or edges only few styles are tried, since each takes a second or more. */
const mostTried = 75;
const countOf = (boxes: BoxTree[]): number => boxes.reduce((sum, box) => sum + 1 + countOf(box.children ?? []), 0);

/** The styles to be tried, in groups: the next group only where nothing of the one before can be read. */
function stylesFor(input: LayoutInput): Style[][] {
  const directions: Style['direction'][] = input.anchorsOf ? ['RIGHT'] : ['RIGHT', 'DOWN'];
  if (!input.shape || input.edges.length > mostRouted) return [[{ direction: 'RIGHT', wraps: false, labels: false }]];
  if (countOf(input.roots) > mostTried || input.edges.length > mostTried) return [directions.map((direction) => ({ direction, wraps: false, labels: false }))];
  const wrappings = input.anchorsOf && endsAtGroups(input) ? [false] : [false, true]; // ports of groups are on both sides of these
  const all = (labels: boolean) => wrappings.flatMap((wraps) => directions.map((direction) => ({ direction, wraps, labels })));
  const labelled = input.edges.some((edge) => edge.labelWidth);
  return [...(labelled ? [all(true)] : []), ...(labelled && input.needsLabels ? [] : [all(false)])];
}

/** The most legible layout: the one that can be shown largest, where none of the first ones can be shown in full size. */
async function bestOf(input: LayoutInput): Promise<Found | null> {
  elk ??= new ElkApi({ workerUrl });
  let best: Found | null = null;
  const zoomOf = (found: Found) => Math.min(1, fittingZoom(found.layout.size, input.shape ?? found.layout.size));
  for (const styles of stylesFor(input)) {
    for (const style of styles) {
      const done = await elk.layout(elkGraph(input, style)).catch(() => null); // not every graph can be wrapped
      if (!done) continue;
      const found = foundIn(done, input);
      const isBetter = !best || found.broken < best.broken || (found.broken === best.broken && zoomOf(found) > 1.05 * zoomOf(best));
      if (isBetter) best = found;
      if (best && best.broken === 0 && zoomOf(best) === 1) return best;
    }
    if (best && best.broken === 0 && zoomOf(best) >= readable) return best;
  }
  return best;
}

/**
 * Places of boxes along the edges, and ways of the edges around them, in the shape of the pane; computed in a worker. With
 * more than mostRouted edges, those between tasks in different boxes are straight lines.
 */
export async function layOut(input: LayoutInput): Promise<Layout> {
  const found = await bestOf(input);
  if (!found) return noLayout;
  const boxes = [...found.laid.values()].map(({ node, x, y }) => ({ x, y, width: node.width ?? 0, height: node.children ? 32 : (node.height ?? 0) }));
  placeLabels(found.layout, boxes, input.edges);
  return found.layout;
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
