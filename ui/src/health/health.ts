// SPDX-License-Identifier: Apache-2.0
import type { Status, Trouble } from '../robot/types';

/** The robot's state in the header: a robot that lacks something is never "idle". */
export function stateText(status: Pick<Status, 'state' | 'health' | 'lost'>): string {
  if (status.lost != null) return 'lost';
  if (status.health?.state !== 'in_trouble') return status.state;
  const count = status.health.troubles.length;
  return 'in trouble: ' + count + (count === 1 ? ' part is' : ' parts are') + ' missing or faulty';
}

export function isInTrouble(status: Pick<Status, 'health' | 'lost'>): boolean {
  return status.lost != null || status.health?.state === 'in_trouble';
}

/** "12 s", "3 min", "2 h", "5 days": as exact as a person needs it. */
export function howLong(seconds: number): string {
  if (seconds < 100) return Math.max(0, Math.round(seconds)) + ' s';
  if (seconds < 100 * 60) return Math.round(seconds / 60) + ' min';
  if (seconds < 48 * 3600) return Math.round(seconds / 3600) + ' h';
  return Math.round(seconds / 86400) + ' days';
}

/** The missing parts of a robot in trouble; empty during a transition, since they may be about to come. */
export function troublesOf(status: Pick<Status, 'health'>): Trouble[] {
  return status.health?.state === 'in_trouble' ? status.health.troubles : [];
}

export function troubleOfTask(status: Pick<Status, 'health'>, task: string): Trouble | undefined {
  return troublesOf(status).find((one) => (one.kind === 'task' || one.kind === 'connection') && one.name === task);
}

/** "12:03:04", the time of the browser's clock at which something was known last. */
export function clockText(time: number): string {
  return new Date(time).toTimeString().slice(0, 8);
}
