// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { bundlesOf, edgesOf, foldedAround, pictureOf, sameStructure, structureOf } from './places';
import { connection, status, task } from './testing';

const none = () => false;
const large = status(
  [task('a'), task('b', { host: 'arm', process: 'p' }), task('c', { host: 'arm', process: 'q', state: 'exception' }), task('d', { host: 'arm', process: 'q' })],
  [connection('a.x', 'b.y'), connection('a.x', 'c.y'), connection('a.z', 'd.y'), connection('c.x', 'd.z'), connection('d.x', 'd.w')],
);
const structure = structureOf(large);

describe('places', () => {
  it('are processes, and hosts with several of them', () => {
    expect(structure.places.map((place) => [place.id, place.inside, place.tasks])).toEqual([
      ['host:arm', undefined, ['b', 'c', 'd']],
      ['group:', undefined, ['a']],
      ['group:arm / p', 'host:arm', ['b']],
      ['group:arm / q', 'host:arm', ['c', 'd']],
    ]);
  });
  it('change with tasks, places and connections, not with values', () => {
    const one = status([task('a')], [connection('a.x', 'a.y', 1)]);
    expect(sameStructure(one, status([task('a', { state: 'stopped' })], [connection('a.x', 'a.y', 9)]))).toBe(true);
    expect(sameStructure(one, status([task('a', { process: 'p' })], [connection('a.x', 'a.y')]))).toBe(false);
    expect(sameStructure(one, status([task('a')], [connection('a.x', 'a.z')]))).toBe(false);
    expect(sameStructure(one, status([task('a'), task('b')], [connection('a.x', 'a.y')]))).toBe(false);
  });
  it('hide what is in them when they are folded', () => {
    const picture = pictureOf(large, structure, (place) => place === 'host:arm', new Set(['c']));
    expect(picture.groups.map((group) => group.id)).toEqual(['group:']);
    expect(picture.nodes.map((node) => [node.id, node.detail, node.look]).sort()).toEqual([
      ['a', 'running', 'tone-good faint'],
      ['host:arm', '3 tasks, 1 in trouble, 1 found', 'tone-bad'],
    ]);
    expect(foldedAround(structure, 'c', (place) => place !== 'group:')?.id).toBe('host:arm');
    expect(foldedAround(structure, 'c', none)).toBeNull();
  });
  it('are drawn inside their hosts', () => {
    const picture = pictureOf(large, structure, (place) => place === 'group:arm / q', null);
    expect(picture.groups.map((group) => [group.id, group.group])).toEqual([['host:arm', undefined], ['group:', undefined], ['group:arm / p', 'host:arm']]);
    expect(picture.nodes.map((node) => [node.id, node.group])).toEqual([['a', 'group:'], ['b', 'group:arm / p'], ['group:arm / q', 'host:arm']]);
  });
});

describe('edges', () => {
  it('join connections between the same two tasks', () => {
    const [bundle, ...more] = bundlesOf(structureOf(status([], [connection('a.b.x', 'c.y'), connection('a.b.z', 'c.w')])), none);
    expect(bundle).toMatchObject({ source: 'a.b', target: 'c', folded: false });
    expect([bundle?.connections.length, more.length]).toEqual([2, 0]);
  });
  it('of folded places are summed; those within are not drawn', () => {
    const bundles = bundlesOf(structure, (place) => place === 'host:arm');
    expect(bundles.map((bundle) => [bundle.id, bundle.connections.length])).toEqual([['a -> host:arm', 3]]);
    expect(edgesOf(large, new Map([['a.x b.y', { rate: 4, latency: 2 }], ['a.z d.y', { rate: 8, latency: 31.25 }]]), bundles)[0]?.label).toBe('×3, 12/s, 31.3 µs');
  });
  it('keep a connection of a task with itself', () => {
    expect(bundlesOf(structure, none).map((bundle) => bundle.id)).toContain('d -> d');
  });
  it('say what was dropped', () => {
    const dropping = status([], [{ ...connection('a.x', 'b.y'), dropped: 3 }]);
    expect(edgesOf(dropping, new Map([['a.x b.y', { rate: 2.5, latency: null }]]), bundlesOf(structureOf(dropping), none))[0]).toMatchObject({ label: '2.5/s, 3 dropped', look: 'warns' });
  });
});
