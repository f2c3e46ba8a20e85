// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { breakpointsAfter, numberOf, oldProblem, unheard, wordsOf, type Asked, type Request } from './requests';
import { control, mission } from './testing';

let id = 0;
const asked = (request: Request, more: Partial<Asked> = {}): Asked => ({ id: ++id, request, number: null, run: 1, state: 'paused', ...more });

describe('a request', () => {
  const step = asked({ what: 'step', how: 'into' }, { number: 4 });
  it('is on its way until the mission has heard it', () => {
    expect(unheard([step], mission({}), control({ heard: 3 }))).toEqual([step]);
    expect(unheard([step], mission({}), control({ heard: 4 }))).toEqual([]);
    const taken = asked({ what: 'pause' });
    expect(unheard([taken], mission({}), control({ heard: 9 }))).toEqual([taken]);
  });
  it('ends with its mission', () => {
    expect(unheard([step], mission({}, { run: 2 }), control())).toEqual([]);
    expect(unheard([step], mission({}, { state: 'ended' }), null)).toEqual([]);
  });
  it('is on its way until the state changes where the mission does not say what it hears', () => {
    const pause = asked({ what: 'pause' }, { number: 1, state: 'running' });
    expect(unheard([pause], mission(null, { state: 'running' }), null)).toEqual([pause]);
    expect(unheard([pause], mission(null), null)).toEqual([]);
  });
  it('that was refused is old once others were heard', () => {
    const problem = { number: 3, text: 'no' };
    expect([oldProblem(control({ heard: 3, problem })), oldProblem(control({ heard: 4, problem })), oldProblem(control({ heard: 4 }))]).toEqual([0, 3, 0]);
  });
  it('has words', () => {
    const all: Request[] = [{ what: 'stop' }, { what: 'step', how: 'out' }, { what: 'break', at: [] }, { what: 'go_on_at', at: 'a/b' }];
    expect(all.map(wordsOf)).toEqual(['stop', 'step out', 'change breakpoints', 'go on at a/b']);
  });
  it('has the number that the verb answers', () => {
    expect([numberOf({ number: 3 }), numberOf(null), numberOf([]), numberOf({ number: 'x' })]).toEqual([3, null, null, null]);
  });
});

describe('breakpoints', () => {
  it('are those of the mission, and what was asked for last', () => {
    const said = control({ breakpoints: ['a'] });
    expect(breakpointsAfter([], said)).toEqual(['a']);
    expect(breakpointsAfter([asked({ what: 'break', at: ['a', 'b'] }), asked({ what: 'break', at: ['b'] }), asked({ what: 'pause' })], said)).toEqual(['b']);
  });
});
