// SPDX-License-Identifier: Apache-2.0
// Sizes of panes, which the browser keeps.

/** No pane becomes smaller, in pixels. */
export const least = 120;

const keyOf = (name: string) => 'segue.pane.' + name;
const variableOf = (name: string) => '--pane-' + name;

/** A size that leaves as much for the pane beside it, of both together. */
export function limited(size: number, both: number): number {
  return Math.round(Math.max(least, Math.min(size, both - least)));
}

/** The kept text as a size; null: it is none. */
export function sizeIn(text: string | null): number | null {
  const size = Number(text ?? NaN);
  return Number.isFinite(size) && size >= least ? size : null;
}

/** Sets the size of a pane, as style.css uses it; null: as it is at first. */
function show(name: string, size: number | null): void {
  const style = document.documentElement.style;
  if (size === null) style.removeProperty(variableOf(name));
  else style.setProperty(variableOf(name), size + 'px');
}

export function resize(name: string, size: number | null): void {
  show(name, size);
  try {
    if (size === null) window.localStorage.removeItem(keyOf(name));
    else window.localStorage.setItem(keyOf(name), String(size));
  } catch {
    // A browser that keeps nothing shows the size all the same.
  }
}

/** Shows the size of before. */
export function restore(name: string): void {
  try {
    show(name, sizeIn(window.localStorage.getItem(keyOf(name))));
  } catch {
    // The browser keeps nothing.
  }
}
