// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Source } from './layout';
import { keptSeconds, ProfileRecorder, TimeRecorder } from './recorder';

const source = (task: string, ...path: string[]): Source => ({ task, port: 'out', path });

describe('the recorder of numbers over time', () => {
  it('has the last seconds of each port at its own times', () => {
    const recorder = new TimeRecorder([source('a', 'x'), source('b')]);
    recorder.add('port/a/out', 0, { x: 1 });
    recorder.add('port/a/out', 11, { x: 2 });
    recorder.add('port/a/out', 11, { x: 9 });
    recorder.add('port/b/out', 12, true);
    const drawn = recorder.drawn(10);
    expect(drawn.labels).toEqual(['a.out x', 'b.out']);
    expect(drawn.data).toEqual([[-1, 0], [2, undefined], [undefined, 1]]);
    expect(recorder.drawn(12).data[0]).toEqual([-12, -1, 0]);
  });
  it('has what was between two times', () => {
    const recorder = new TimeRecorder([source('a', 'x'), source('b')]);
    for (let time = 100; time <= 110; ++time) recorder.add('port/a/out', time, { x: time });
    recorder.add('port/b/out', 104, 7);
    expect(recorder.between(103, 105, 104)).toEqual({ labels: ['a.out x', 'b.out'], data: [[-1, 0, 1], [103, 104, 105], [undefined, 7, undefined]] });
    expect(recorder.between(90, 99.5, 95)).toEqual({ labels: [], data: [[]] });
    expect(recorder.between(110.5, 120, 111)).toEqual({ labels: [], data: [[]] });
    expect(recorder.between(100.2, 100.8, 100)).toEqual({ labels: [], data: [[]] });
  });
  it('forgets what is older than ten minutes, or the older half', () => {
    const recorder = new TimeRecorder([source('a')]);
    for (let time = 0; time <= keptSeconds + 10; ++time) recorder.add('port/a/out', time, time);
    expect(recorder.between(0, 1e9, 0).data[0][0]).toBe(10);
    expect(recorder.size).toBe(2 * (keptSeconds + 1));
    recorder.halve();
    expect(recorder.between(0, 1e9, 0).data[0][0]).toBe(10 + 301);
    expect(recorder.size).toBe(600);
  });
  it('makes one line for each element of a list', () => {
    const recorder = new TimeRecorder([source('a')]);
    recorder.add('port/a/out', 1, [1, null]);
    recorder.add('port/a/out', 2, [3, 4, 5]);
    expect(recorder.drawn(10)).toEqual({ labels: ['a.out[0]', 'a.out[1]', 'a.out[2]'], data: [[-1, 0], [1, 3], [null, 4], [null, 5]] });
    recorder.add('port/a/out', 3, new Array<number>(1000).fill(0));
    expect(recorder.drawn(10).labels).toHaveLength(32);
  });
  it('does not join what is on both sides of a pause', () => {
    const recorder = new TimeRecorder([source('a')]);
    recorder.add('port/a/out', 1, 1);
    recorder.gap();
    recorder.add('port/a/out', 2, 2);
    expect(recorder.drawn(10).data[1]).toEqual([1, null, 2]);
  });
  it('has nothing to draw at first', () => {
    expect(new TimeRecorder([source('a')]).drawn(10)).toEqual({ labels: [], data: [[]] });
  });
});

describe('the recorder of profiles', () => {
  it('has the newest lists over their indices', () => {
    const recorder = new ProfileRecorder([source('a', 'r'), source('b')]);
    recorder.add('port/a/out', 1, { r: [1, null, 3] });
    recorder.add('port/b/out', 1, [5]);
    recorder.add('port/b/out', 2, [6]);
    expect(recorder.drawn()).toEqual({ labels: ['a.out r', 'b.out'], data: [[0, 1, 2], [1, null, 3], [6, null, null]] });
    recorder.add('port/a/out', 2, { other: 1 });
    expect(recorder.drawn().data).toEqual([[0], [null], [6]]);
  });
});
