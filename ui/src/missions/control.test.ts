// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { controlOf, positionOf, preemptedBy, stepButtons, whyNotAt, withToggled } from './control';
import { livesOf } from './mission';
import { control, entries, mission } from './testing';

describe('how a mission can be steered', () => {
  it('is what the document says', () => {
    const values = { number: 2, of: 'a', when: 'next', inputs: [{ name: 'x', type: 'int', text: '1' }, { name: 'y', type: 'list', text: '[', cut: true }], outputs: [] };
    const said = { steps: true, back: false, at: ['a', 'b/c'], breakpoints: ['a'], heard: 2, problem: { number: 1, text: 'no' }, values };
    expect(controlOf(mission(said))).toEqual({
      ...said,
      values: { ...values, inputs: [{ name: 'x', type: 'int', text: '1', cut: false }, { name: 'y', type: 'list', text: '[', cut: true }] },
    });
  });
  it('is unknown where the program does not say it, says it wrongly, or has ended', () => {
    expect(controlOf(null)).toBeNull();
    expect(controlOf(mission(null))).toBeNull();
    expect(controlOf(mission({ heard: 'often' }))).toBeNull();
    expect(controlOf(mission(control(), { state: 'ended' }))).toBeNull();
    expect(controlOf(mission({ heard: 1, at: [1], breakpoints: 'a', values: [], problem: 3 }))).toEqual({ steps: false, back: false, at: null, breakpoints: [], heard: 1 });
  });
  it('has another position where it has gone on', () => {
    const at = (one: ReturnType<typeof mission>) => positionOf(one, controlOf(one) ?? control());
    const first = mission(control(), { entries: entries(['a']) });
    expect(at(first)).toBe(at(mission(control({ heard: 7, breakpoints: ['b'] }), { entries: entries(['a']) })));
    expect(at(first)).not.toBe(at(mission(control(), { entries: entries(['a'], ['a', 'success']) })));
    expect(at(first)).not.toBe(at(mission(control({ at: ['b'] }), { entries: entries(['a']) })));
    expect(at(first)).not.toBe(at(mission(control(), { run: 2, entries: entries(['a']) })));
  });
});

describe('the buttons', () => {
  const reasons = (state: string, more = {}, busy = false) => stepButtons(state, control(more), busy).map((one) => one.reason);
  it('step where the mission is held', () => {
    expect(reasons('paused')).toEqual(['', '', '', '']);
    expect(stepButtons('paused', control(), false).map((one) => one.how + one.key)).toEqual(['intos', 'overn', 'outf', 'backr']);
  });
  it('say why they do not', () => {
    expect(reasons('running', { at: null })).toEqual(Array(4).fill('the mission must be paused first'));
    expect(reasons('paused', { at: null })[0]).toBe('what is under way has not ended yet');
    expect(reasons('stopping', { at: null })[1]).toBe('the mission is being stopped');
    expect(reasons('paused', {}, true)[2]).toBe('the mission has not heard yet what it was asked for');
    expect(reasons('paused', { back: false })).toEqual(['', '', '', 'the mission was started without --steps-back']);
  });
});

describe('going on elsewhere', () => {
  const kinds = new Map([['', 'hierarchy'], ['a', 'hierarchy'], ['both', 'barrier'], ['both/right', 'hierarchy']]);
  it('preempts what runs in the innermost container around it that runs', () => {
    const lives = livesOf(mission(null, { entries: entries(['a/b/x'], ['a/c'], ['d']) }));
    expect(preemptedBy('e', lives)).toEqual(['a', 'd']);
    expect(preemptedBy('a/e', lives)).toEqual(['a/b', 'a/c']);
    expect(preemptedBy('a/b/y/z', lives)).toEqual(['a/b/x']);
    expect(preemptedBy('a/b', lives)).toEqual(['a/b', 'a/c']);
    expect(preemptedBy('f/g', lives)).toEqual(['a', 'd']);
  });
  it('preempts the containers in which the mission is held, not what is next there', () => {
    const lives = livesOf(mission(null, { entries: entries(['a/b'], ['a/b', 'success']) }), ['a/c']);
    expect(preemptedBy('d', lives)).toEqual(['a']);
    expect(preemptedBy('a/b', lives)).toEqual([]);
  });
  it('cannot begin one of concurrent states, but goes on within one that runs', () => {
    const before = livesOf(mission(null), ['a']);
    expect(whyNotAt('both', before, kinds)).toBe('');
    expect(whyNotAt('both/left', before, kinds)).not.toBe('');
    expect(whyNotAt('both/right/x', before, kinds)).not.toBe('');
    const inside = livesOf(mission(null), ['both/left', 'both/right/x']);
    expect(whyNotAt('both/left', inside, kinds)).not.toBe('');
    expect(whyNotAt('both/right/y', inside, kinds)).toBe('');
    expect(whyNotAt('a/b', inside, kinds)).toBe('');
  });
});

describe('the lives of states', () => {
  it('know where the mission is held', () => {
    const lives = livesOf(mission(null, { entries: entries(['a/b'], ['a/b', 'success']) }), ['a/c', 'd']);
    expect([...lives]).toEqual([['a', 'running'], ['a/b', 'done'], ['a/c', 'next'], ['d', 'next']]);
  });
  it('go on beside a state that may not begin', () => {
    const lives = livesOf(mission(null, { entries: entries(['a/b'], ['a/c', 'aborted']) }));
    expect([...lives]).toEqual([['a', 'running'], ['a/b', 'running'], ['a/c', 'failed']]);
  });
});

describe('a breakpoint', () => {
  it('is set and removed', () => {
    expect(withToggled(['a'], 'b')).toEqual(['a', 'b']);
    expect(withToggled(['a', 'b'], 'a')).toEqual(['b']);
  });
});
