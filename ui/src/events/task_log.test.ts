// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { entriesOf, eventsOfTask, outputCommand } from './task_log';

const event = (number: number, time: string, subject: string, message = '') => ({ number, time, kind: 'action_done', subject, message });
const line = (number: number, time: string, message: string) => ({ number, time, level: 'warning', message });

describe('the log of a task', () => {
  it('has the events that name the task', () => {
    const events = [event(1, '1', 'start drive'), event(2, '2', 'connect drive.out laser.in'), event(3, '3', 'start drive2'), event(4, '4', 'drive')];
    expect(eventsOfTask(events, 'drive').map((one) => one.number)).toEqual([1, 2, 4]);
    expect(eventsOfTask(events, 'laser').map((one) => one.number)).toEqual([2]);
  });
  it('has lines and events in the order of time, the newest last', () => {
    const entries = entriesOf([line(7, '2', 'hot'), line(8, '4', 'hotter')], [event(1, '1', 'start drive', 'took 1 us'), event(2, '3', 'drive')], 'drive', 10);
    expect(entries.map((one) => one.text)).toEqual(['start drive: took 1 us', 'hot', 'drive', 'hotter']);
    expect(entries.map((one) => one.kind)).toEqual(['action_done', 'warning', 'action_done', 'warning']);
    expect(entries.map((one) => one.isOwn)).toEqual([false, true, false, true]);
  });
  it('is part of the output of a process', () => {
    expect(outputCommand('localhost', 'sensors')).toBe('segue log sensors');
    expect(outputCommand('base', 'sensors')).toBe('segue log base/sensors --hosts ROBOT_FILE');
    expect(outputCommand('localhost', '')).toBeNull();
  });
  it('keeps the newest of many, and the order of what has one time', () => {
    const lines = [line(1, '1', 'a'), line(2, '1', 'b'), line(3, '1', 'c')];
    expect(entriesOf(lines, [], 'drive', 2).map((one) => one.text)).toEqual(['b', 'c']);
  });
});
