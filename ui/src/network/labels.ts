// SPDX-License-Identifier: Apache-2.0
// Labels of edges, where the layout has kept no room for them.
import { labelHeight } from './elk_graph';
import type { Box, Layout, LayoutInput } from './boxes';
import type { Point } from './route';

/** Where labels are tried, along each part of an edge. */
const tried = [0.5, 0.3, 0.7, 0.15, 0.85];
/** With more edges nobody can tell which label belongs to which. */
const mostPlaced = 150;

const meets = (a: Box, b: Box) => a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;

/** The box around a label of that width. */
export function labelBox(middle: Point, width: number): Box {
  return { x: middle.x - width / 2, y: middle.y - labelHeight / 2, width, height: labelHeight };
}

/** Middles of labels along an edge: first those on level parts, the longest first. */
function placesAlong(route: Point[]): Point[] {
  const parts = route.slice(1).map((end, index) => {
    const begin = route[index] as Point;
    const level = Math.abs(end.y - begin.y) < 0.5;
    return { begin, end, weight: Math.hypot(end.x - begin.x, end.y - begin.y) * (level ? 1 : 0.1) };
  });
  parts.sort((a, b) => b.weight - a.weight);
  return parts.flatMap(({ begin, end }) => tried.map((at) => ({ x: begin.x + at * (end.x - begin.x), y: begin.y + at * (end.y - begin.y) })));
}

/** Gives each edge that has none a place for its label at which it covers no box and no other label, as far as there is one. */
export function placeLabels(layout: Layout, boxes: Box[], edges: LayoutInput['edges']): void {
  if (edges.length > mostPlaced) return;
  const widths = new Map(edges.map((edge) => [edge.id, edge.labelWidth ?? 0]));
  const taken = [...boxes, ...[...layout.labels].map(([id, at]) => labelBox(at, widths.get(id) ?? 0))];
  const isFree = (box: Box) =>
    box.x >= 0 && box.y >= 0 && box.x + box.width <= layout.size.width && box.y + box.height <= layout.size.height && !taken.some((other) => meets(box, other));
  for (const { id, labelWidth } of edges) {
    const route = layout.routes.get(id);
    if (!labelWidth || !route || layout.labels.has(id)) continue;
    const place = placesAlong(route).find((at) => isFree(labelBox(at, labelWidth)));
    if (!place) continue;
    layout.labels.set(id, place);
    taken.push(labelBox(place, labelWidth));
  }
}
