// SPDX-License-Identifier: Apache-2.0

export interface Point {
  x: number;
  y: number;
}

const cornerRadius = 6;

function distance(a: Point, b: Point): number {
  return Math.hypot(b.x - a.x, b.y - a.y);
}

/** The point that is `length` away from `from` towards `to`. */
function towards(from: Point, to: Point, length: number): Point {
  const all = distance(from, to);
  return all === 0 ? from : { x: from.x + ((to.x - from.x) * length) / all, y: from.y + ((to.y - from.y) * length) / all };
}

/** The path of an SVG through all points, with rounded corners. */
export function pathOf(points: Point[]): string {
  const text = (point: Point) => point.x.toFixed(1) + ' ' + point.y.toFixed(1);
  return points
    .map((point, index) => {
      const before = points[index - 1];
      const after = points[index + 1];
      if (!before) return 'M ' + text(point);
      if (!after) return 'L ' + text(point);
      const radius = Math.min(cornerRadius, distance(before, point) / 2, distance(point, after) / 2);
      return 'L ' + text(towards(point, before, radius)) + ' Q ' + text(point) + ' ' + text(towards(point, after, radius));
    })
    .join(' ');
}

/** The middle of the longest level part, where a label is read best; of the longest part where none is level. */
export function labelPlace(points: Point[]): Point {
  let best = { length: -1, middle: points[0] ?? { x: 0, y: 0 } };
  points.slice(1).forEach((end, index) => {
    const begin = points[index] as Point;
    const level = Math.abs(end.y - begin.y) < 0.5;
    const length = distance(begin, end) * (level ? 1 : 0.1);
    if (length > best.length) best = { length, middle: { x: (begin.x + end.x) / 2, y: (begin.y + end.y) / 2 } };
  });
  return best.middle;
}

/** The head of an arrow at the end, as a path of an SVG. */
export function arrowOf(points: Point[]): string {
  const end = points[points.length - 1];
  const before = points[points.length - 2];
  if (!end || !before) return '';
  const all = distance(before, end) || 1;
  const [x, y] = [((end.x - before.x) / all) * 7, ((end.y - before.y) / all) * 7];
  const text = (point: Point) => point.x.toFixed(1) + ' ' + point.y.toFixed(1);
  return 'M ' + text(end) + ' L ' + text({ x: end.x - x - y / 2, y: end.y - y + x / 2 }) + ' L ' + text({ x: end.x - x + y / 2, y: end.y - y - x / 2 }) + ' Z';
}
