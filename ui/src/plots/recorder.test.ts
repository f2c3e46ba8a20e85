// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Source } from './layout';
import { ProfileRecorder, TimeRecorder } from './recorder';

const source = (task: string, ...path: string[]): Source => ({ task, port: 'out', path });

describe('the recorder of numbers over time', () => {
  it('keeps the last seconds of each port at its own times', () => {
    const recorder = new TimeRecorder([source('a', 'x'), source('b')], 10);
    recorder.add('port/a/out', 0, { x: 1 });
    recorder.add('port/a/out', 11, { x: 2 });
    recorder.add('port/a/out', 11, { x: 9 });
    recorder.add('port/b/out', 12, true);
    const drawn = recorder.drawn();
    expect(drawn.labels).toEqual(['a.out x', 'b.out']);
    expect(drawn.data).toEqual([[-1, 0], [2, undefined], [undefined, 1]]);
  });
  it('makes one line for each element of a list', () => {
    const recorder = new TimeRecorder([source('a')], 10);
    recorder.add('port/a/out', 1, [1, null]);
    recorder.add('port/a/out', 2, [3, 4, 5]);
    expect(recorder.drawn()).toEqual({ labels: ['a.out[0]', 'a.out[1]', 'a.out[2]'], data: [[-1, 0], [1, 3], [null, 4], [null, 5]] });
    recorder.add('port/a/out', 3, new Array<number>(1000).fill(0));
    expect(recorder.drawn().labels).toHaveLength(32);
  });
  it('does not join what is on both sides of a pause', () => {
    const recorder = new TimeRecorder([source('a')], 10);
    recorder.add('port/a/out', 1, 1);
    recorder.gap();
    recorder.add('port/a/out', 2, 2);
    expect(recorder.drawn().data[1]).toEqual([1, null, 2]);
  });
  it('has nothing to draw at first', () => {
    expect(new TimeRecorder([source('a')], 10).drawn()).toEqual({ labels: [], data: [[]] });
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
