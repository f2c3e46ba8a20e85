// SPDX-License-Identifier: Apache-2.0
import { restOfAddress } from '../address';
import { localText } from '../local_time';
import { isMap, type Json } from '../robot/change';
import type { RobotEvent } from '../robot/types';

/** The events of the document, in their order. */
export function eventsOf(value: Json | undefined): RobotEvent[] {
  if (!isMap(value)) return [];
  return (Object.values(value) as unknown as RobotEvent[]).sort((a, b) => a.number - b.number);
}

/** The events that have all the words, in any of their texts. */
export function withWords(events: RobotEvent[], words: string): RobotEvent[] {
  const wanted = words.toLowerCase().split(/\s+/).filter((word) => word !== '');
  return events.filter((event) => {
    const text = [event.kind, event.subject, event.message, event.number, localText(Date.parse(event.time))].join(' ').toLowerCase();
    return wanted.every((word) => text.includes(word));
  });
}

/** "#events/drive" searches for "drive". */
export function wordsOfAddress(hash: string): string {
  return restOfAddress(hash, 'events');
}

export function isTrouble(event: RobotEvent): boolean {
  return event.trouble ?? /failed|refused|given_up|lost|undone|difference/.test(event.kind);
}
