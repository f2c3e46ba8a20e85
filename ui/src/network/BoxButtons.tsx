// SPDX-License-Identifier: Apache-2.0
import { createContext, useContext } from 'react';

/** Something that can be set at a box and removed again. */
export interface BoxMark {
  on: boolean;
  /** The kind of the mark and the name of the box. */
  label: string;
  /** The mark is shown only; it cannot be changed. */
  fixed?: boolean;
}

/** The actions of the buttons in boxes, by the id of the box. */
export interface BoxActions {
  toggle: (id: string) => void;
  mark: (id: string) => void;
}
export const BoxActionsContext = createContext<BoxActions>({ toggle: () => {}, mark: () => {} });

/** These buttons are for the pointer; at the keyboard the box itself has keys for both. */
const byPointer = { type: 'button', tabIndex: -1 } as const;

/** Opens and closes a box; nothing where it cannot be opened. */
export function OpenButton({ id, title, expanded }: { id: string; title: string; expanded?: boolean }) {
  const { toggle } = useContext(BoxActionsContext);
  if (expanded === undefined) return null;
  return (
    <button
      {...byPointer} className="box-open nopan" aria-expanded={expanded} aria-label={(expanded ? 'Close ' : 'Open ') + title}
      onClick={(event) => [event.stopPropagation(), toggle(id)]}
    >
      {expanded ? '▾' : '▸'}
    </button>
  );
}

/** Sets and removes the mark of a box; nothing where it has none. */
export function MarkButton({ id, mark }: { id: string; mark?: BoxMark }) {
  const { mark: change } = useContext(BoxActionsContext);
  if (!mark || (mark.fixed && !mark.on)) return null;
  return (
    <button
      {...byPointer} className="box-mark nopan" aria-pressed={mark.on} aria-label={mark.label} title={mark.label} disabled={mark.fixed}
      onClick={(event) => [event.stopPropagation(), change(id)]}
    />
  );
}
