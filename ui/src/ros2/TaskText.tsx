// SPDX-License-Identifier: Apache-2.0
import { useState } from 'react';
import { reason } from '../reason';
import type { Ros2Node } from './ros2';

/** The node as a task of a network, to be copied. */
export function TaskText({ node }: { node: Ros2Node }) {
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
    <details className="task-text">
      <summary>As a task of a network</summary>
      <div className="row">
        <button type="button" onClick={() => void copy()}>Copy</button>
        {note && <output className={note.bad ? 'bad' : 'good'}>{note.text}</output>}
      </div>
      <pre tabIndex={0} aria-label={'Task for ' + node.name}>{node.text}</pre>
    </details>
  );
}
