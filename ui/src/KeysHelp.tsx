// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef } from 'react';
import { isTyping } from './keys';

const groups: { title: string; keys: [string, string][] }[] = [
  { title: 'Everywhere', keys: [['1 … 8', 'the views'], ['/', 'search'], ['Escape', 'closes what was opened last'], ['?', 'these keys'], ['← → ↑ ↓', 'at the line between two panes: resizes them; Home sets them back']] },
  { title: 'Graphs', keys: [['Tab', 'goes from box to box'], ['Enter', 'selects a task or state; folds and unfolds a process or host'], ['← →', 'close and open a state with states in it']] },
  { title: 'Missions', keys: [['c', 'pauses and resumes'], ['s', 'steps into'], ['n', 'steps over'], ['f', 'steps out'], ['r', 'steps back'], ['b', 'sets or removes a breakpoint'], ['+ −', 'zoom the chart, which the arrow keys move']] },
  { title: 'Plots', keys: [['← → ↑ ↓', 'move a map, turn a 3D view (with Shift: move it)'], ['← →', 'at a chart beside a film: move the film'], ['+ −', 'zoom']] },
  { title: 'Edit', keys: [['Ctrl+S', 'saves the text'], ['Ctrl+Z', 'undoes, Ctrl+Y does again'], ['Delete', 'removes what is selected in the graph']] },
];

/** The button for the list of all keys, which the key "?" opens, too. */
export function KeysHelp() {
  const dialog = useRef<HTMLDialogElement>(null);
  const open = () => !dialog.current?.open && dialog.current?.showModal();
  useEffect(() => {
    const press = (event: KeyboardEvent) => event.key === '?' && !isTyping(event) && open();
    window.addEventListener('keydown', press);
    return () => window.removeEventListener('keydown', press);
  }, []);
  return (
    <>
      <button type="button" className="keys-button" aria-label="Keys" title="Keys ( ? )" onClick={open}>?</button>
      <dialog ref={dialog} className="keys" aria-label="Keys">
        <form method="dialog"><button aria-label="Close the keys">×</button></form>
        {groups.map(({ title, keys }) => (
          <section key={title}>
            <h2>{title}</h2>
            <dl>
              {keys.map(([key, what]) => <div key={key}><dt><kbd>{key}</kbd></dt><dd>{what}</dd></div>)}
            </dl>
          </section>
        ))}
      </dialog>
    </>
  );
}
