// SPDX-License-Identifier: Apache-2.0
import type { LogLine, RobotEvent } from '../robot/types';

/** A line of a task's own, or an event that names it. */
export interface TaskEntry {
  key: string;
  time: string;
  /** The level of a line, or the kind of an event. */
  kind: string;
  text: string;
  isOwn: boolean;
}

/** Events whose subject names the task: "start drive", "drive.out drive.in" or "drive" itself. */
export function eventsOfTask(events: RobotEvent[], task: string): RobotEvent[] {
  return events.filter((event) => (' ' + event.subject.replace(/\.\w+/g, ' ') + ' ').includes(' ' + task + ' '));
}

/** The command that shows all output of a task's process; null for the runtime's own, whose output is not kept. */
export function outputCommand(host: string, process: string): string | null {
  if (process === '') return null;
  return host === '' || host === 'localhost' ? 'segue log ' + process : `segue log ${host}/${process} --hosts ROBOT_FILE`;
}

/** The log of a task and the events that name it in the order of time, the newest last; of more than `most` the newest. */
export function entriesOf(lines: LogLine[], events: RobotEvent[], task: string, most: number): TaskEntry[] {
  const own = lines.map((line): TaskEntry => ({ key: 'line ' + line.number, time: line.time, kind: line.level, text: line.message, isOwn: true }));
  const others = eventsOfTask(events, task).map((event): TaskEntry => ({
    key: 'event ' + event.number, time: event.time, kind: event.kind, text: [event.subject, event.message].filter((part) => part !== '').join(': '), isOwn: false,
  }));
  // Entries of the same time keep their order.
  return [...own, ...others].sort((a, b) => (a.time < b.time ? -1 : a.time > b.time ? 1 : 0)).slice(-most);
}
