// SPDX-License-Identifier: Apache-2.0
import { fittingZoom, margin, readable, type Size } from './boxes';
import type { Point } from './route';

const largest = 1.15;

export interface View extends Point {
  zoom: number;
}

/** Where a graph begins in a pane, along one axis: in its middle where it fits, else with the box at `first` in view. */
function offset(whole: number, pane: number, zoom: number, first: number): number {
  const free = margin * pane;
  if (whole * zoom <= pane - 2 * free + 1) return (pane - whole * zoom) / 2;
  const past = Math.min(first * zoom, whole * zoom - (pane - 2 * free));
  return first * zoom < pane / 2 ? free : free - past;
}

/** All of a graph, or as much as can be read, with the box at `first` in view. */
export function fitted(size: Size, pane: Size, first: Point): View {
  const zoom = Math.min(largest, Math.max(readable, fittingZoom(size, pane)));
  return { x: offset(size.width, pane.width, zoom, first.x), y: offset(size.height, pane.height, zoom, first.y), zoom };
}
