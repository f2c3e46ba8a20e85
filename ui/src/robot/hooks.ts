// SPDX-License-Identifier: Apache-2.0
import { createContext, useContext, useEffect, useSyncExternalStore } from 'react';
import type { Connection, Link, Shown } from './connection';

export const ConnectionContext = createContext<Connection | null>(null);

export function useConnection(): Connection {
  const connection = useContext(ConnectionContext);
  if (!connection) throw new Error('there is no connection around this component');
  return connection;
}

/** A document, as long as the component is shown; null: none. */
export function useDocument(name: string | null): Shown | undefined {
  const connection = useConnection();
  useEffect(() => (name === null ? undefined : connection.subscribe(name)), [connection, name]);
  return useSyncExternalStore(connection.onChange, () => (name === null ? undefined : connection.shown(name)));
}

export function useLink(): Link {
  const connection = useConnection();
  return useSyncExternalStore(connection.onChange, () => connection.link);
}
