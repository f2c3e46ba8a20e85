// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json } from '../robot/change';
import { portOf, taskOf, type Direction, type PortModel } from '../robot/types';
import type { NetworkText } from './text';

export interface PropertyModel {
  name: string;
  type: string;
  default?: Json;
  live?: boolean;
  doc?: string;
}

export interface EditedPort extends PortModel {
  /** `name` is a regular expression for ports that are created by configuration. */
  pattern?: boolean;
}

export interface ComponentModel {
  name: string;
  doc: string;
  abstract: boolean;
  library: string;
  ports: EditedPort[];
  properties: PropertyModel[];
}

export type Models = Map<string, ComponentModel>;

/** The models in the answer to the request `models`. */
export function modelsOf(value: Json): Models {
  const components = isMap(value) ? value['components'] : null;
  const models: Models = new Map();
  for (const [name, model] of Object.entries(isMap(components) ? components : {})) {
    const { doc, abstract, library, ports, properties } = model as unknown as Partial<ComponentModel>;
    const portModels = (ports ?? []).map((port) => ({ ...port, name: port.name ?? (port as unknown as { pattern: string }).pattern, pattern: Boolean(port.pattern) }));
    models.set(name, { name, doc: doc ?? '', abstract: abstract ?? false, library: library ?? '', ports: portModels, properties: properties ?? [] });
  }
  return models;
}

/** Components with all of these words, by name. */
export function found(models: Models, words: string): ComponentModel[] {
  const wanted = words.toLowerCase().split(/\s+/).filter((word) => word !== '');
  return [...models.values()]
    .filter((model) => !model.abstract && wanted.every((word) => (model.name + ' ' + model.doc).toLowerCase().includes(word)))
    .sort((a, b) => a.name.localeCompare(b.name));
}

/** The port "task.port" of a network; null where its component or the port is not known. */
export function portIn(network: NetworkText, models: Models, port: string): EditedPort | null {
  const task = network.tasks.find((one) => one.id === taskOf(port));
  return models.get(task?.component ?? '')?.ports.find((one) => !one.pattern && one.name === portOf(port)) ?? null;
}

/** The ports that a task is drawn with: those of its component, and others that are connected. */
export function portsOf(network: NetworkText, models: Models, id: string): EditedPort[] {
  const component = network.tasks.find((task) => task.id === id)?.component ?? '';
  const used = new Map<string, Direction>();
  for (const connection of network.connections) {
    if (connection && taskOf(connection.from) === id) used.set(portOf(connection.from), 'output');
    if (connection && taskOf(connection.to) === id) used.set(portOf(connection.to), 'input');
  }
  // Every task has a port `state`; few are connected.
  const known = (models.get(component)?.ports ?? []).filter((port) => !port.pattern && (port.name !== 'state' || used.has('state')));
  for (const port of known) used.delete(port.name);
  return [...known, ...[...used].map(([name, direction]) => ({ name, direction, type: '', doc: '' }))];
}

/** Why these two cannot be connected; null: they can. */
export function refusal(network: NetworkText, models: Models, from: string, to: string): string | null {
  const output = portIn(network, models, from);
  const input = portIn(network, models, to);
  if (output && output.direction !== 'output') return from + ' is not an output port';
  if (input && input.direction !== 'input') return to + ' is not an input port';
  if (output?.type && input?.type && output.type !== input.type) return from + ' has the type ' + output.type + ', ' + to + ' the type ' + input.type;
  if (network.connections.some((one) => one?.from === from && one.to === to)) return from + ' and ' + to + ' are connected already';
  return null;
}

/** The ports that can be connected with an output port, or with an input port. */
export function partners(network: NetworkText, models: Models, port: string, direction: Direction): string[] {
  return network.tasks
    .flatMap((task) => portsOf(network, models, task.id).filter((one) => one.direction !== direction).map((one) => task.id + '.' + one.name))
    .filter((other) => (direction === 'output' ? refusal(network, models, port, other) : refusal(network, models, other, port)) === null);
}

/** "drive" for demo::Drive, "drive_2" where there is one. */
export function newId(network: NetworkText, component: string): string {
  const name = (component.split('::').pop() ?? component).replace(/([a-z0-9])([A-Z])/g, '$1_$2').toLowerCase();
  const taken = new Set(network.tasks.map((task) => task.id));
  let id = name;
  for (let number = 2; taken.has(id); ++number) id = name + '_' + number;
  return id;
}
