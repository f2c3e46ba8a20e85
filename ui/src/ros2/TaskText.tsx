// SPDX-License-Identifier: Apache-2.0
import { lazy, Suspense, useState } from 'react';
import { reason } from '../reason';
import { useConnection } from '../robot/hooks';
import type { Ros2Node } from './ros2';

const AddToNetwork = lazy(() => import('../edit/AddToNetwork').then((part) => ({ default: part.AddToNetwork }))); // the editor is large

/** The node as a task of a network, to be copied. */
export function TaskText({ node }: { node: Ros2Node }) {
  const connection = useConnection();
  const [open, setOpen] = useState(false);
  const [note, setNote] = useState<{ text: string; bad: boolean } | null>(null);
  const copy = async () => {
    try {
      await navigator.clipboard.writeText(node.text);
      setNote({ text: 'copied', bad: false });
    } catch (error) {
      setNote({ text: 'not copied: ' + reason(error), bad: true });
    }
  };
  return (
    <details className="task-text" onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary>As a task of a network</summary>
      <div className="row">
        <button type="button" onClick={() => void copy()}>Copy</button>
        {note && <output className={note.bad ? 'bad' : 'good'}>{note.text}</output>}
        {open && connection.mayOperate && <Suspense fallback="…"><AddToNetwork written={node.text} /></Suspense>}
      </div>
      <pre tabIndex={0} aria-label={'Task for ' + node.name}>{node.text}</pre>
    </details>
  );
}
