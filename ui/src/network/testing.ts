// SPDX-License-Identifier: Apache-2.0
// Small statuses for tests.
import type { ConnectionStatus, Status, TaskStatus } from '../robot/types';

export function task(id: string, more: Partial<TaskStatus> = {}): TaskStatus {
  return {
    id, component: 'demo::' + id, state: 'running', state_name: 'running', host: '', process: '', pid: 1,
    cycle_us: 1, worst_us: 1, cycles: 1, missed: 0, error: '', ...more,
  };
}

export function connection(from: string, to: string, written = 0): ConnectionStatus {
  return { from, to, policy: 'data', size: 1, written, read: 0, dropped: 0 };
}

export function status(tasks: TaskStatus[], connections: ConnectionStatus[] = []): Status {
  return {
    robot: 'r', controller: 'c', state: 'idle', commanded_by: null, halt: null, stopped_by: null, controllers: [], ready: [],
    tasks: Object.fromEntries(tasks.map((one) => [one.id, one])),
    connections: Object.fromEntries(connections.map((one) => [one.from + ' ' + one.to, one])),
    requests: [], differences: [], uptime_s: 1,
  };
}
