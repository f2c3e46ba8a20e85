// SPDX-License-Identifier: Apache-2.0
// The elements that Graph draws: boxes, boxes around them, and arrows.
import { nodeWidth } from './boxes';
import type { BoxMark } from './BoxButtons';

export interface GraphNode {
  id: string;
  group?: string;
  title: string;
  detail: string;
  /** Which colours: a class of style.css. */
  look: string;
  /** A group that is closed: a click opens it. */
  folded?: boolean;
  /** A button in it opens it; a click selects it. */
  expanded?: boolean;
  mark?: BoxMark;
  /** The graph, or its group, is read from it on. */
  first?: boolean;
  /** Has details that need more room than its title. */
  isWide?: boolean;
}
export interface GraphEdge {
  id: string;
  source: string;
  target: string;
  label?: string;
  /** The width of labels as they change; undefined: it has none. */
  room?: number;
  look: string;
}
export interface GraphGroup {
  id: string;
  title: string;
  /** The group around it; groups come before those in them. */
  group?: string;
  look?: string;
  /** A button in it, and no click, closes it; a click selects it. */
  expanded?: boolean;
  mark?: BoxMark;
  first?: boolean;
}

/** About that of a character of a label, and what is left free around the label. */
const labelStep = 7.4;
const labelMargin = 5;

/** The width of a label; of none for an empty one. */
export const labelWidth = (text: string): number => (text === '' ? 0 : text.length * labelStep + 2 * labelMargin);

const titleStep = 8.2;
const leastWidth = 124;
const mostWidth = 240;

/** The width of a box that its title needs. */
export const titleWidth = (title: string): number => Math.round(Math.min(mostWidth, title.length * titleStep + 34));

export function boxWidth({ title, isWide }: { title: string; isWide?: boolean }): number {
  return Math.max(isWide ? nodeWidth : leastWidth, titleWidth(title));
}
