// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Values } from './control';
import { control } from './testing';
import { ValueAsker } from './values';

function begun(): ValueAsker {
  const asker = new ValueAsker();
  asker.see(1, control(), 'here');
  return asker;
}
const answer = (number: number, of: string): Values => ({ number, of, when: 'next', inputs: [], outputs: [] });

describe('the values of states', () => {
  it('are asked for where they are not known', () => {
    const asker = begun();
    expect(asker.next([], 'here')).toBeNull();
    expect(asker.next(['a', 'b'], 'here')).toBe('a');
    asker.asks('a', 'here');
    expect(asker.next(['a', 'b'], 'here')).toBeNull();
    asker.took(1);
    asker.see(1, control({ heard: 1, values: answer(1, 'a') }), 'here');
    expect(asker.of('a', 'here')).toEqual({ values: answer(1, 'a'), isCurrent: true });
    expect(asker.next(['a', 'b'], 'here')).toBe('b');
  });
  it('are asked for again where the mission has gone on', () => {
    const asker = begun();
    asker.asks('a', 'here');
    asker.took(1);
    asker.see(1, control({ heard: 1, values: answer(1, 'a') }), 'there');
    expect(asker.of('a', 'there')).toEqual({ values: answer(1, 'a'), isCurrent: false });
    expect(asker.next(['a'], 'there')).toBe('a');
    asker.asks('a', 'there');
    asker.took(2);
    asker.see(1, control({ heard: 2, values: answer(2, 'a') }), 'there');
    expect(asker.next(['a'], 'there')).toBeNull();
  });
  it('are taken where the document is faster than the answer of the robot', () => {
    const asker = begun();
    const said = control({ heard: 1, values: answer(1, 'a') });
    asker.asks('a', 'here');
    asker.see(1, said, 'here');
    asker.took(1);
    asker.see(1, said, 'here');
    expect(asker.next(['a'], 'here')).toBeNull();
    expect(asker.next(['b'], 'here')).toBe('b');
  });
  it('stay known when another browser asks for others, and are taken from its answers', () => {
    const asker = begun();
    asker.see(1, control({ values: answer(1, 'a') }), 'here');
    asker.see(1, control({ values: answer(2, 'b') }), 'here');
    expect(asker.next(['a', 'b'], 'here')).toBeNull();
    expect(asker.of('a', 'here')?.values.number).toBe(1);
  });
  it('are asked for again where the answer to another browser was shown instead', () => {
    const asker = begun();
    asker.asks('a', 'here');
    asker.took(1);
    asker.see(1, control({ heard: 2, values: answer(2, 'b') }), 'here');
    expect(asker.next(['a'], 'here')).toBe('a');
  });
  it('are not asked for again where they were refused', () => {
    const asker = begun();
    asker.asks('a', 'here');
    asker.took(1);
    asker.see(1, control({ heard: 1, problem: { number: 1, text: 'no such state' } }), 'here');
    expect(asker.next(['a'], 'here')).toBeNull();
    expect(asker.of('a', 'here')).toBeNull();
    expect(asker.next(['a'], 'there')).toBe('a');
    asker.asks('a', 'there');
    asker.failed();
    expect(asker.next(['a'], 'there')).toBeNull();
  });
  it('are forgotten with their run', () => {
    const asker = begun();
    asker.see(1, control({ values: answer(5, 'a') }), 'here');
    asker.see(2, control(), 'here');
    expect(asker.of('a', 'here')).toBeNull();
    asker.see(2, control({ values: answer(1, 'a') }), 'here');
    expect(asker.of('a', 'here')?.values.number).toBe(1);
  });
});
