// SPDX-License-Identifier: Apache-2.0
import { Handle, Position, type Node, type NodeProps } from '@xyflow/react';
import { MarkButton, OpenButton, type BoxMark } from './BoxButtons';

/** The state of the buttons of a box. */
export type Buttons = { expanded?: boolean; mark?: BoxMark };
export type TaskNode = Node<{ title: string; detail: string; look: string; folded?: boolean } & Buttons, 'task'>;
export type GroupNode = Node<{ title: string; look: string } & Buttons, 'place'>;

function TaskBox({ id, data, selected }: NodeProps<TaskNode>) {
  return (
    <div className={'task-box ' + data.look + (selected ? ' selected' : '') + (data.folded ? ' folded' : '')}>
      <Handle type="target" position={Position.Left} isConnectable={false} />
      <strong><OpenButton id={id} title={data.title} expanded={data.expanded} />{data.title}</strong>
      <span title={data.detail}>{data.detail}</span>
      <MarkButton id={id} mark={data.mark} />
      <Handle type="source" position={Position.Right} isConnectable={false} />
    </div>
  );
}

function PlaceBox({ id, data, selected }: NodeProps<GroupNode>) {
  return (
    <div className={'place-box ' + data.look + (selected ? ' selected' : '')}>
      <Handle type="target" position={Position.Left} isConnectable={false} />
      <OpenButton id={id} title={data.title} expanded={data.expanded} />
      <span className="place-title" title={data.title}>{data.title}</span>
      <MarkButton id={id} mark={data.mark} />
      <Handle type="source" position={Position.Right} isConnectable={false} />
    </div>
  );
}

export const nodeTypes = { task: TaskBox, place: PlaceBox };
