// SPDX-License-Identifier: Apache-2.0
import type { ReactNode } from 'react';
import { addressOf } from '../address';
import { Name } from '../Name';
import type { Status } from '../robot/types';
import { NodeNames } from './NodeNames';
import { limitsText, notesOf, processText, qualityText, taskBehind, tasksOf, valueText, type EndOfTopic, type Named, type Parameter, type Ros2Node, type Ros2Seen } from './ros2';
import { StateBadge } from './StateBadge';
import { TaskText } from './TaskText';
import { Mismatches } from './TopicList';

/** A table with a title; nothing where it has no rows. */
function Section({ title, columns, rows }: { title: string; columns: string[]; rows: ReactNode[][] }) {
  if (rows.length === 0) return null;
  return (
    <section aria-label={title}>
      <h3>{title}</h3>
      <table>
        <thead><tr>{columns.map((column) => <th key={column} scope="col">{column}</th>)}</tr></thead>
        <tbody>
          {rows.map((cells, row) => <tr key={row}>{cells.map((cell, at) => <td key={at}>{cell}</td>)}</tr>)}
        </tbody>
      </table>
    </section>
  );
}

function Topics({ title, ends, seen, publishes, node }: { title: string; ends: EndOfTopic[]; seen: Ros2Seen; publishes: boolean; node: string }) {
  const rows = ends.map(({ topic, type, quality }) => {
    const known = seen.topics.find((one) => one.topic === topic);
    const mine = known?.mismatches.filter((one) => (publishes ? one.publisher : one.subscription) === node) ?? [];
    return [
      <><Name text={topic} />{known && <Mismatches topic={{ ...known, mismatches: mine }} />}</>,
      <Name text={type} />, qualityText(quality),
      <NodeNames names={(publishes ? known?.subscriptions : known?.publishers) ?? []} />,
    ];
  });
  return <Section title={title} columns={['Topic', 'Type', 'Quality', publishes ? 'Subscribed to by' : 'Published by']} rows={rows} />;
}

function NamedList({ title, all }: { title: string; all: Named[] }) {
  return <Section title={title} columns={['Name', 'Type']} rows={all.map(({ name, type }) => [<Name text={name} />, <Name text={type} />])} />;
}

function Parameters({ all }: { all: Parameter[] }) {
  const rows = all.map((one) => [<Name text={one.name} />, <code>{valueText(one.value)}</code>, one.kind, limitsText(one), one.description]);
  return <Section title="Parameters" columns={['Name', 'Value', 'Kind', 'Limits', 'Meaning']} rows={rows} />;
}

/** Which tasks of the robot have to do with the node. */
function TasksOfNode({ node, seen, status }: { node: Ros2Node; seen: Ros2Seen; status: Status }) {
  const own = taskBehind(node, seen, status);
  const tasks = tasksOf(node, seen, status);
  const links = (ids: string[]) => ids.map((id, index) => <span key={id}>{index > 0 && ', '}<a href={addressOf('network', id)}>{id}</a></span>);
  return (
    <p>
      {own && <>It is the robot&apos;s task {links([own])}. </>}
      {own === '' && 'It is a node of Segue. '}
      {tasks.length > 0 && <>The robot&apos;s task {links(tasks)} stands for it.</>}
      {tasks.length === 0 && own === null && <span className="quiet">No task of the robot that runs stands for it.</span>}
    </p>
  );
}

/** All that is known of one node. */
export function NodeDetails({ node, seen, status }: { node: Ros2Node; seen: Ros2Seen; status: Status }) {
  return (
    <div className="scroll node" tabIndex={0} role="region" aria-label={'Node ' + node.name}>
      <h2><Name text={node.name} /> <StateBadge node={node} /></h2>
      <p className="quiet">process: {processText(node)}</p>
      <TasksOfNode node={node} seen={seen} status={status} />
      {notesOf(node).map((note) => <p key={note} className="warning">{note}</p>)}
      <TaskText node={node} />
      <Topics title="Publishes" ends={node.publishers} seen={seen} publishes node={node.name} />
      <Topics title="Subscribes to" ends={node.subscriptions} seen={seen} publishes={false} node={node.name} />
      <NamedList title="Services" all={node.services} />
      <NamedList title="Calls services" all={node.clients} />
      <NamedList title="Actions" all={node.actions} />
      <NamedList title="Uses actions" all={node.action_clients} />
      <Parameters all={node.parameters} />
    </div>
  );
}
