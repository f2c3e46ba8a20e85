// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json } from '../robot/change';
import type { Status } from '../robot/types';

/** A look at ROS 2, as the studio answers `look_at_ros2` (segue/web/ros2_looks.hpp). */
export interface Ros2Seen {
  /** The domain that was looked at. */
  domain: number;
  place: Place;
  /** Those of the robot's tasks. */
  places: Place[];
  nodes: Ros2Node[];
  topics: Ros2Topic[];
  /** The robot's tasks of ROS 2. */
  tasks: Record<string, TaskOfRos2>;
}

/** -1 and '': as the environment of the studio says. */
export interface Place {
  domain: number;
  discovery: string;
}

export interface TaskOfRos2 {
  name?: string;
  node?: string;
}

/** An endpoint of a node. */
export interface EndOfTopic {
  topic: string;
  type: string;
  quality: Record<string, string>;
}

export interface Named {
  name: string;
  type: string;
}

export interface Parameter {
  name: string;
  kind: string;
  value: Json;
  read_only: boolean;
  description: string;
  constraints: string;
  range?: { from: number; to: number; step: number };
}

export interface Ros2Node {
  name: string;
  managed: boolean;
  /** Of a managed node; '' where it does not say. */
  state?: string;
  publishers: EndOfTopic[];
  subscriptions: EndOfTopic[];
  services: Named[];
  clients: Named[];
  actions: Named[];
  action_clients: Named[];
  parameters: Parameter[];
  /** How many nodes have the name. */
  copies: number;
  unseen_endpoints: number;
  /** The questions that it has not answered. */
  problems: string[];
  /** Absent where it is not on the studio's computer, or another user's. */
  process?: { pid: number; nodes: number; program: string; package?: string; executable?: string };
  /** The node as a task of a network. */
  text: string;
}

export interface Mismatch {
  publisher: string;
  subscription: string;
  reasons: string[];
}

/** A node is '' where none says that the endpoint is its own. */
export interface Ros2Topic {
  topic: string;
  types: string[];
  publishers: string[];
  subscriptions: string[];
  mismatches: Mismatch[];
}

export function seenIn(answer: Json): Ros2Seen | null {
  return isMap(answer) && Array.isArray(answer['nodes']) && Array.isArray(answer['topics']) && isMap(answer['tasks']) ? (answer as unknown as Ros2Seen) : null;
}

/** Whether the robot has, or can have, tasks of ROS 2. */
export function hasRos2(status: Pick<Status, 'tasks' | 'libraries'> | null): boolean {
  if (!status) return false;
  return (status.libraries ?? []).includes('segue_components_ros2') || Object.values(status.tasks).some(({ component }) => component.startsWith('ros2::'));
}

const proxies = ['ros2::Node', 'ros2::ManagedNode'];
const plain = (id: string) => id.replace(/[^A-Za-z0-9_]/g, '_');
const rooted = (name: string) => (name.startsWith('/') ? name : '/' + name);
const last = (name: string) => name.slice(name.lastIndexOf('/') + 1);

/** The node that a task of ROS 2 stands for, or that others see of it; null: it is none of these. */
export function nodeOfTask(id: string, component: string, properties: { [name: string]: Json }): string | null {
  if (!component.startsWith('ros2::')) return null;
  const text = (name: string) => (typeof properties[name] === 'string' ? properties[name] : '');
  if (proxies.includes(component)) return text('name') || null;
  return rooted(text('node') || plain(id));
}

type Tasks = Pick<Status, 'tasks'>;

/** The tasks that stand for a node. */
export function tasksOf(node: Ros2Node, seen: Ros2Seen, { tasks }: Tasks): string[] {
  return Object.entries(seen.tasks).filter(([id, { name }]) => name === node.name && proxies.includes(tasks[id]?.component ?? '')).map(([id]) => id);
}

/** Whether a node is of Segue, and the robot's task that is this node; '': of another robot, or not known. null: it is not of Segue. */
export function taskBehind(node: Ros2Node, seen: Ros2Seen, { tasks }: Tasks): string | null {
  if (!node.process?.program.startsWith('segue')) return null;
  const near = Object.values(tasks).filter((task) => task.pid === node.process?.pid);
  const own = near.find(({ id, component }) => {
    const name = rooted(seen.tasks[id]?.node || plain(id));
    return component.startsWith('ros2::') && (name === node.name || (proxies.includes(component) && '/_segue_' + plain(id) === node.name));
  });
  if (own) return own.id;
  const isExposed = near.some(({ component }) => component === 'ros2::Exposure');
  return (isExposed && Object.keys(tasks).find((id) => plain(id) === last(node.name))) || '';
}

/** Nodes of tools, such as those of `ros2` itself. */
export const isHidden = (node: Ros2Node) => last(node.name).startsWith('_');

export interface NodeGroup {
  title: string;
  nodes: Ros2Node[];
}

/** Nodes of others, those of Segue, and hidden ones; groups without nodes are left out. */
export function groupsOf(nodes: Ros2Node[], seen: Ros2Seen, status: Tasks): NodeGroup[] {
  const isOfSegue = (node: Ros2Node) => taskBehind(node, seen, status) !== null;
  const groups = [
    { title: 'Nodes', nodes: nodes.filter((node) => !isOfSegue(node) && !isHidden(node)) },
    { title: 'Nodes of Segue', nodes: nodes.filter(isOfSegue) },
    { title: 'Hidden nodes', nodes: nodes.filter((node) => !isOfSegue(node) && isHidden(node)) },
  ];
  return groups.filter((group) => group.nodes.length > 0);
}

/** Those whose texts have all the words. */
export function withAllWords<One>(all: One[], words: string, textsOf: (one: One) => string[]): One[] {
  const wanted = words.toLowerCase().split(/\s+/).filter((word) => word !== '');
  return all.filter((one) => {
    const text = textsOf(one).join(' ').toLowerCase();
    return wanted.every((word) => text.includes(word));
  });
}

export function placeText({ domain, discovery }: Place): string {
  return (domain < 0 ? 'the domain of the environment' : 'domain ' + domain) + (discovery === '' ? '' : ', ' + discovery);
}

/** "best_effort, volatile, deadline 100ms" */
export function qualityText(quality: Record<string, string>): string {
  const words = ['reliability', 'durability', 'liveliness'];
  return Object.entries(quality).map(([name, value]) => (words.includes(name) ? value : name + ' ' + value)).join(', ');
}

/** "read-only, 1 to 40, step 1" */
export function limitsText({ read_only, range, constraints }: Parameter): string {
  const parts = [read_only ? 'read-only' : '', range ? range.from + ' to ' + range.to : '', range && range.step !== 0 ? 'step ' + range.step : '', constraints];
  return parts.filter((part) => part !== '').join(', ');
}

export const valueText = (value: Json): string => (typeof value === 'string' ? value : JSON.stringify(value));

export function processText({ process }: Ros2Node): string {
  if (!process) return "not known: it is not on the studio's computer, or another user's";
  const program = process.package === undefined ? process.program : process.package + ' ' + process.executable;
  return program + ' (' + process.pid + ')' + (process.nodes > 1 ? ', with ' + process.nodes + ' nodes' : '');
}

/** Sentences: that there are several nodes of the name, and which parts of it are not known. */
export function notesOf(node: Ros2Node): string[] {
  return [
    ...(node.copies > 1 ? [node.copies + ' nodes have this name'] : []),
    ...(node.unseen_endpoints > 0 ? [node.unseen_endpoints + ' of its topics or services have not been found in time'] : []),
    ...node.problems,
  ];
}

/** The mismatch in words. */
export function mismatchText({ publisher, subscription, reasons }: Mismatch): string {
  const named = (node: string) => node || 'a program that is not a node';
  return named(subscription) + ' gets nothing from ' + named(publisher) + ': ' + reasons.join('; ');
}
