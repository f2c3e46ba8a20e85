// SPDX-License-Identifier: Apache-2.0
import type { ReactNode } from 'react';
import { Splitter } from './Splitter';

/** The panel at the right of a view. All have one width. */
export function Panel({ label, children }: { label: string; children: ReactNode }) {
  return (
    <>
      <Splitter name="panel" label="Width of the panel" axis="x" sized="after" />
      <aside className="panel" aria-label={label} tabIndex={0}>{children}</aside>
    </>
  );
}

/** The list from which something is chosen, at the left of a view. */
export function ListPane({ label, children }: { label: string; children: ReactNode }) {
  return (
    <>
      <section className="controllers" aria-label={label}>{children}</section>
      <Splitter name="list" label="Width of the list" axis="x" sized="before" />
    </>
  );
}
