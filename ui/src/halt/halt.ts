// SPDX-License-Identifier: Apache-2.0
import type { Status } from '../robot/types';

/** The facts about a halted robot that a person must know; nothing where it was not halted. */
export function haltText(status: Pick<Status, 'halt' | 'stopped_by'>): string {
  const { halt } = status;
  const parts: string[] = [];
  if (halt) {
    const rest = halt.state === 'halting' ? 'on its way to rest' : halt.state === 'at_rest' ? 'at rest' : 'not at rest in time: ' + (halt.trouble ?? '');
    parts.push('Halted by ' + halt.who + (halt.why ? ' (' + halt.why + ')' : '') + ': ' + rest + '.');
  }
  if (halt?.stopped?.length) parts.push('Stopped, since they hold devices: ' + halt.stopped.join(', ') + '.');
  if (status.stopped_by != null) parts.push('Whatever is requested is refused until it is released.');
  return parts.join(' ');
}
