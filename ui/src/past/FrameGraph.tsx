// SPDX-License-Identifier: Apache-2.0
import { useMemo } from 'react';
import { FoldingGraph } from '../network/FoldingGraph';
import { groupsOf, type Frame, type Presence } from './film';

const looks: Record<Presence, string> = { there: 'there', 'not yet': 'not-there', gone: 'not-there' };

/** The network of a frame, drawn as in the view Network; elements that are not there yet or not any more are faint. */
export function FrameGraph({ label, frame }: { label: string; frame: Frame }) {
  const groups = useMemo(() => groupsOf(frame), [frame]);
  const nodes = useMemo(
    () =>
      frame.tasks.map((task) => ({
        id: task.id,
        group: 'group:' + task.place,
        title: task.id,
        detail: task.presence === 'there' ? task.state : task.presence,
        look: 'fate-' + task.fate + ' ' + looks[task.presence],
      })),
    [frame],
  );
  const edges = useMemo(() => frame.edges.map((edge) => ({ ...edge, look: 'fate-' + edge.fate + ' ' + looks[edge.presence] })), [frame]);
  return <FoldingGraph label={label} groups={groups} nodes={nodes} edges={edges} quiet="fate-unchanged there" mixed="fate-changed there" />;
}
