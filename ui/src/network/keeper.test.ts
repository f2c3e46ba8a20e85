// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Keeper } from './keeper';

function round(keeper: Keeper<{ label: string }>, labels: Record<string, string>) {
  keeper.begin();
  const made = Object.entries(labels).map(([id, label]) => keeper.keep(id, [label], () => ({ label })));
  keeper.end();
  return made;
}

describe('objects of a list', () => {
  it('stay the same as long as their parts do', () => {
    const keeper = new Keeper<{ label: string }>();
    const first = round(keeper, { a: '1', b: '1' });
    const second = round(keeper, { a: '1', b: '2' });
    expect(second[0]).toBe(first[0]);
    expect(second[1]).toEqual({ label: '2' });
  });
  it('are forgotten once they are gone', () => {
    const keeper = new Keeper<{ label: string }>();
    const first = round(keeper, { a: '1' });
    round(keeper, {});
    expect(round(keeper, { a: '1' })[0]).not.toBe(first[0]);
  });
});
