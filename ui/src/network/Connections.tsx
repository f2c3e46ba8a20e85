// SPDX-License-Identifier: Apache-2.0
import type { Status } from '../robot/types';
import { connectionsOf, describeConnection } from './connections';
import type { Flows } from './graph';

/** The connections of a task with the figures that its edges show, and more. */
export function Connections({ id, status, flows }: { id: string; status: Status; flows: Flows }) {
  const connections = connectionsOf(status, id);
  return (
    <section aria-label="Connections">
      <h3>Connections</h3>
      {connections.length === 0 && <p className="quiet">none</p>}
      <ul className="plain connections">
        {connections.map(([key, connection]) => (
          <li key={key} className={connection.dropped > 0 ? 'drops' : ''}>
            {connection.from} → {connection.to}
            <div className="quiet">{describeConnection(connection, flows.get(key))}</div>
          </li>
        ))}
      </ul>
    </section>
  );
}
