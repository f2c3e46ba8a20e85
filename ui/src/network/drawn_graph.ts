// SPDX-License-Identifier: Apache-2.0
// The elements that Graph draws: boxes, boxes around them, and arrows.
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
}
export interface GraphEdge {
  id: string;
  source: string;
  target: string;
  label?: string;
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
}
