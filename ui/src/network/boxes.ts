// SPDX-License-Identifier: Apache-2.0
// Graphs to be laid out, and the result.
import { Position } from '@xyflow/react';
import type { Point } from './route';

export const nodeWidth = 200;
export const nodeHeight = 50;

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
  /** The graph is read from it on. */
  first?: boolean;
}

export interface Size {
  width: number;
  height: number;
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
  /** Edges between nodes, or between their anchors that have an id; `labelWidth`: of the text at it. */
  edges: { id: string; source: string; target: string; sourceAnchor?: string; targetAnchor?: string; labelWidth?: number }[];
  /** All labels are needed; else those for which there is no room are left out. */
  needsLabels?: boolean;
  /** Between boxes one after another, as far as there are no labels; enough for arrows unless given. */
  distance?: number;
  /** Of the pane in which the graph is shown, in pixels. */
  shape?: Size;
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
  /** The middles of labels for which there is room. */
  labels: Map<string, Point>;
  size: Size;
}

export const noLayout: Layout = { boxes: new Map(), routes: new Map(), labels: new Map(), size: { width: 0, height: 0 } };

/** The least zoom at which texts of graphs, of 13 pixels, can be read. */
export const readable = 0.86;
/** The free space around a graph, as a part of the pane. */
export const margin = 0.03;

/** The zoom at which all of the graph is in the pane. */
export function fittingZoom(size: Size, pane: Size): number {
  const free = 1 - 2 * margin;
  return Math.min((free * pane.width) / Math.max(1, size.width), (free * pane.height) / Math.max(1, size.height));
}
