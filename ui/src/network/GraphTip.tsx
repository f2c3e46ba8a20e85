// SPDX-License-Identifier: Apache-2.0
import { useStore } from '@xyflow/react';
import type { CSSProperties, ReactNode, RefObject } from 'react';

const gap = 6;
const widest = 320;
/** The least height that has room for a tip. */
const lowest = 110;
/** The height of a group's title. */
const titleHeight = 30;

export interface Span {
  upper: number;
  lower: number;
}

/** Where a tip of the box between `upper` and `lower` is: below it, or above it, or else below its title; all in pixels of the window. */
export function placeOfTip({ upper, lower }: Span, title: number, window: number): CSSProperties {
  if (window - lower >= lowest) return { top: lower + gap, maxHeight: window - lower - 2 * gap };
  if (upper >= lowest) return { bottom: window - upper + gap, maxHeight: upper - 2 * gap };
  const top = Math.max(upper, 0) + title + gap;
  return { top, maxHeight: window - top - gap };
}

interface Props {
  id: string;
  /** The place of the box, in the coordinates of the graph. */
  x: number;
  y: number;
  height: number;
  frame: RefObject<HTMLElement | null>;
  children: ReactNode;
  onEnter: () => void;
  onLeave: () => void;
}

/** A few words beside a box. They may reach beyond the graph. */
export function GraphTip({ id, x, y, height, frame, children, onEnter, onLeave }: Props) {
  const [left, top, zoom] = useStore((store) => store.transform);
  const corner = frame.current?.getBoundingClientRect();
  if (!corner) return null;
  const upper = corner.top + top + y * zoom;
  const place = placeOfTip({ upper, lower: upper + height * zoom }, titleHeight * zoom, globalThis.innerHeight);
  return (
    <div
      className="graph-tip" role="tooltip" id={id} onMouseEnter={onEnter} onMouseLeave={onLeave}
      style={{ ...place, left: Math.max(gap, Math.min(corner.left + left + x * zoom, globalThis.innerWidth - widest - gap)), maxWidth: widest }}
    >
      {children}
    </div>
  );
}
