// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from 'react';
import { isMap } from '../robot/change';
import type { Connection } from '../robot/connection';
import { useConnection } from '../robot/hooks';
import type { PortModel, Status, TaskReport } from '../robot/types';

export interface PortOfTask {
  task: string;
  port: string;
  type: string;
  doc: string;
}

/** Outputs of tasks by the tasks' ids and components; ports do not change while a task runs. */
const known = new Map<string, PortOfTask[]>();
const atOnce = 4;

async function ask(connection: Connection, task: string): Promise<PortOfTask[]> {
  const report = await connection.call('task', { task });
  const ports: PortModel[] = isMap(report) ? (report as unknown as TaskReport).ports : [];
  return ports.filter((port) => port.direction !== 'input').map((port) => ({ task, port: port.name, type: port.type, doc: port.doc }));
}

/** The output ports of the tasks that run, as far as they are known yet; asked of the robot once. */
export function usePorts(status: Status): { ports: PortOfTask[]; left: number } {
  const connection = useConnection();
  const [, setCount] = useState(0);
  const keys = Object.values(status.tasks).map((task) => task.id + '\n' + task.component);
  const all = keys.join('\n\n');
  useEffect(() => {
    let ends = false;
    const waiting = all.split('\n\n').filter((key) => key !== '' && !known.has(key));
    const work = async () => {
      for (let key = waiting.shift(); key !== undefined && !ends; key = waiting.shift()) {
        // A task that has gone meanwhile has no ports; it is asked again when it is back.
        const ports = await ask(connection, key.split('\n')[0]!).catch(() => null);
        if (ports) known.set(key, ports);
        setCount((count) => count + 1);
      }
    };
    for (let index = 0; index < atOnce; ++index) void work();
    return () => {
      ends = true;
    };
  }, [connection, all]);
  return { ports: keys.flatMap((key) => known.get(key) ?? []), left: keys.filter((key) => !known.has(key)).length };
}

/** Ports that have all the words in their names, types ("/demo/Pose", also as "demo::Pose") or descriptions. */
export function portsWith(ports: PortOfTask[], words: string): PortOfTask[] {
  const wanted = words.toLowerCase().split(/\s+/).filter((word) => word !== '');
  return ports.filter((port) => {
    const text = [port.task + '.' + port.port, port.type, port.type.slice(1).replace(/\//g, '::'), port.doc].join(' ').toLowerCase();
    return wanted.every((word) => text.includes(word));
  });
}
