// SPDX-License-Identifier: Apache-2.0
import { taskOf, type ConnectionStatus, type Status } from '../robot/types';
import { rateText, type Flow } from './graph';
import { microsecondsText } from '../units';

/** The connections of a task with their keys, those that lead to it first. */
export function connectionsOf(status: Status, task: string): [string, ConnectionStatus][] {
  const all = Object.entries(status.connections);
  const inputs = all.filter(([, connection]) => taskOf(connection.to) === task);
  return [...inputs, ...all.filter(([, connection]) => taskOf(connection.from) === task && taskOf(connection.to) !== task)];
}

/** "data, 50/s, latency 3.1 µs, 40 µs at the most; 100 written, 98 read, 2 dropped". */
export function describeConnection(connection: ConnectionStatus, flow: Flow | undefined): string {
  const worst = connection.latency_worst_us ?? 0;
  const flows = [
    connection.policy + (connection.size > 1 ? ' of ' + connection.size : ''),
    rateText(flow?.rate ?? 0),
    flow && flow.latency !== null ? `latency ${microsecondsText(flow.latency)}, ${microsecondsText(worst)} at the most` : '',
  ].filter((part) => part !== '');
  return `${flows.join(', ')}; ${connection.written} written, ${connection.read} read, ${connection.dropped} dropped`;
}
