// SPDX-License-Identifier: Apache-2.0
import { useEffect, useLayoutEffect, useRef, useState, type KeyboardEvent, type PointerEvent } from 'react';
import { limited, least, resize, restore } from './sizes';
import './panes.css';

const step = 24;

interface Props {
  /** Of the size, which the browser keeps. */
  name: string;
  label: string;
  /** Along which it moves. */
  axis: 'x' | 'y';
  /** The pane that has that size: the one before it, or the one after it. */
  sized: 'before' | 'after';
}

/** The line between two panes: dragged, or moved by arrow keys; a double click, or Home, sets it back. */
export function Splitter({ name, label, axis, sized }: Props) {
  const line = useRef<HTMLDivElement>(null);
  const [now, setNow] = useState({ size: 0, both: 0 });
  const measure = () => {
    const [before, after] = [line.current?.previousElementSibling?.getBoundingClientRect(), line.current?.nextElementSibling?.getBoundingClientRect()];
    if (!before || !after) return null;
    const sizeOf = (box: DOMRect) => (axis === 'x' ? box.width : box.height);
    const start = axis === 'x' ? before.left : before.top;
    return { start, size: sizeOf(sized === 'before' ? before : after), both: sizeOf(before) + sizeOf(after) };
  };
  const note = () => {
    const found = measure();
    if (found) setNow({ size: Math.round(found.size), both: Math.round(found.both) });
  };
  useLayoutEffect(() => restore(name), [name]);
  useEffect(note, []); // eslint-disable-line react-hooks/exhaustive-deps
  const set = (size: number | null) => {
    const both = measure()?.both ?? 0;
    resize(name, size === null ? null : limited(size, both));
    note();
  };
  const drag = (event: PointerEvent) => {
    const found = event.currentTarget.hasPointerCapture(event.pointerId) ? measure() : null;
    if (!found) return;
    const from = (axis === 'x' ? event.clientX : event.clientY) - found.start;
    set(sized === 'before' ? from : found.both - from);
  };
  const press = (event: KeyboardEvent) => {
    const way = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 }[event.key];
    if (way !== undefined) set((measure()?.size ?? 0) + (sized === 'before' ? way : -way) * step);
    if (event.key === 'Home') set(null);
    if (way !== undefined || event.key === 'Home') event.preventDefault();
  };
  return (
    <div
      ref={line} className={'splitter along-' + axis} role="separator" tabIndex={0} aria-label={label} aria-orientation={axis === 'x' ? 'vertical' : 'horizontal'}
      aria-valuenow={now.size} aria-valuemin={Math.min(least, now.size)} aria-valuemax={Math.max(now.size, now.both - least)} title="Drag to resize; a double click sets it back"
      onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)} onPointerMove={drag} onKeyDown={press} onDoubleClick={() => set(null)}
    />
  );
}
