// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { eventsOf, isTrouble, withWords, wordsOfAddress } from './filter';

const document = {
  '10': { number: 10, time: 't', kind: 'action_done', subject: 'start drive', message: '1us' },
  '9': { number: 9, time: 't', kind: 'transition_failed', subject: 'go_to', message: 'start of drive failed' },
};

describe('events', () => {
  it('are in their order', () => {
    expect(eventsOf(document).map((event) => event.number)).toEqual([9, 10]);
    expect(eventsOf(null)).toEqual([]);
  });
  it('are found by words', () => {
    expect(withWords(eventsOf(document), 'DRIVE failed').map((event) => event.number)).toEqual([9]);
    expect(withWords(eventsOf(document), '  ')).toHaveLength(2);
  });
  it('are searched by an address', () => {
    expect(['#events/drive', '#events/a%20b', '#events', '#events/', '#network/x', '#events/%', ''].map(wordsOfAddress)).toEqual(['drive', 'a b', '', '', '', '', '']);
  });
  it('are trouble or not', () => {
    expect(eventsOf(document).map(isTrouble)).toEqual([true, false]);
  });
});
