// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { found, modelsOf, newId, partners, portsOf, refusal } from './models';
import { networkIn } from './text';

const models = modelsOf({
  components: {
    't::Source': { doc: 'makes numbers', ports: [{ name: 'out', direction: 'output', type: '/double' }, { name: 'state', direction: 'output', type: '/int32_t' }] },
    't::BigSink': { ports: [{ name: 'in', direction: 'input', type: '/double' }, { name: 'text', direction: 'input', type: '/string' }, { pattern: 'in_.*', direction: 'input', type: '/double' }] },
    't::Base': { abstract: true },
  },
});
const network = networkIn('network: a\ntasks:\n  s: {component: t::Source}\n  b: {component: t::BigSink}\n  u: {component: t::Unknown}\nconnections: [s.out -> b.in, s.state -> u.x, u.y -> b.in_1]\n')!;

it('only ports of one type are connected', () => {
  expect(refusal(network, models, 's.out', 'b.text')).toContain('type');
  expect(refusal(network, models, 's.out', 'b.in')).toContain('already');
  expect(refusal(network, models, 'b.in', 's.out')).toContain('not an output port');
  expect(refusal(network, models, 's.out', 'b.in_2')).toBeNull();
  expect(refusal(network, models, 'u.z', 'b.text')).toBeNull();
  expect(partners(network, models, 's.out', 'output')).toEqual(['b.in_1', 'u.x']);
  expect(partners(network, models, 'b.text', 'input')).toEqual(['u.y']);
});
it('tasks are drawn with the ports of their components and with those that are connected', () => {
  expect(portsOf(network, models, 's').map((port) => port.name)).toEqual(['out', 'state']);
  expect(portsOf(network, models, 'b').map((port) => port.name)).toEqual(['in', 'text', 'in_1']);
  expect(portsOf(network, models, 'u').map((port) => port.name + ' ' + port.direction)).toEqual(['x input', 'y output']);
});
it('components are found by words, abstract ones never', () => {
  expect(found(models, '').map((model) => model.name)).toEqual(['t::BigSink', 't::Source']);
  expect(found(models, 'NUMBERS make').map((model) => model.name)).toEqual(['t::Source']);
});
it('new tasks have names that are free', () => {
  expect(newId(network, 't::BigSink')).toBe('big_sink');
  expect(newId(networkIn('network: a\ntasks: {drive: {component: x}, drive_2: {component: x}}\n')!, 'demo::Drive')).toBe('drive_3');
});
