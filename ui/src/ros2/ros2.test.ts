// SPDX-License-Identifier: Apache-2.0
import { describe, expect, test } from 'vitest';
import type { TaskStatus } from '../robot/types';
import { groupsOf, hasRos2, limitsText, mismatchText, nodeOfTask, notesOf, placeText, processText, qualityText, seenIn, taskBehind, tasksOf, valueText, withAllWords, type Ros2Node, type Ros2Seen } from './ros2';

const node = (name: string, more: Partial<Ros2Node> = {}): Ros2Node => ({
  name, managed: false, publishers: [], subscriptions: [], services: [], clients: [], actions: [], action_clients: [], parameters: [], copies: 1, unseen_endpoints: 0, problems: [], text: '', ...more,
});
const process = (pid: number, program: string) => ({ pid, nodes: 1, program });
const task = (id: string, component: string, pid: number) => ({ id, component, pid }) as TaskStatus;
const status = {
  tasks: {
    lidar: task('lidar', 'ros2::ManagedNode', 7), 'front.cam': task('front.cam', 'ros2::Subscription', 7), voice: task('voice', 'ros2::Publisher', 7),
    show: task('show', 'ros2::Exposure', 8), 'arm.left': task('arm.left', 'demo::Arm', 9),
  },
};
const seen: Ros2Seen = {
  domain: 7, place: { domain: 7, discovery: '' }, places: [], nodes: [], topics: [],
  tasks: { lidar: { name: '/robot/lidar', node: '' }, 'front.cam': { node: '' }, voice: { node: 'robot/speaker' }, show: {} },
};

describe('a task of ROS 2', () => {
  test('stands for the node that it names', () => {
    expect(nodeOfTask('lidar', 'ros2::ManagedNode', { name: '/robot/lidar', node: '' })).toBe('/robot/lidar');
    expect(nodeOfTask('lidar', 'ros2::Node', { name: '' })).toBeNull();
    expect(tasksOf(node('/robot/lidar'), seen, status)).toEqual(['lidar']);
    expect(tasksOf(node('/lidar'), seen, status)).toEqual([]);
  });

  test('is a node itself, whose name is its own unless it has another', () => {
    expect(nodeOfTask('front.cam', 'ros2::Subscription', { node: '' })).toBe('/front_cam');
    expect(nodeOfTask('voice', 'ros2::Publisher', { node: 'robot/speaker' })).toBe('/robot/speaker');
    expect(nodeOfTask('arm', 'demo::Arm', { node: '/arm' })).toBeNull();
  });

  test('that has gone meanwhile stands for nothing', () => {
    expect(tasksOf(node('/robot/lidar'), seen, { tasks: {} })).toEqual([]);
  });
});

test('a robot has to do with ROS 2 where it has tasks or components of it', () => {
  expect(hasRos2(null)).toBe(false);
  expect(hasRos2({ tasks: {}, libraries: ['segue_components_demo'] })).toBe(false);
  expect(hasRos2({ tasks: {}, libraries: ['segue_components_ros2'] })).toBe(true);
  expect(hasRos2(status)).toBe(true); // that of an older Segue tells no libraries
});

test('a node of Segue is known by its process, and its task by its name', () => {
  const behind = (name: string, pid: number, program = 'segue-deployment') => taskBehind(node(name, { process: process(pid, program) }), seen, status);
  expect(behind('/front_cam', 7)).toBe('front.cam');
  expect(behind('/robot/speaker', 7)).toBe('voice');
  expect(behind('/_segue_lidar', 7)).toBe('lidar');
  expect(behind('/robot/arm_left', 8)).toBe('arm.left');
  expect(behind('/front_cam', 99)).toBe('');
  expect(behind('/arm_left', 7)).toBe(''); // no task of that process shows others
  expect(behind('/front_cam', 7, 'rviz2')).toBeNull();
  expect(taskBehind(node('/front_cam'), seen, status)).toBeNull();
});

test('nodes of others come first, and hidden ones last', () => {
  const nodes = [node('/_ros2cli'), node('/front_cam', { process: process(7, 'segue') }), node('/slam')];
  expect(groupsOf(nodes, seen, status).map(({ title, nodes: those }) => [title, those.map((one) => one.name)])).toEqual([['Nodes', ['/slam']], ['Nodes of Segue', ['/front_cam']], ['Hidden nodes', ['/_ros2cli']]]);
  expect(groupsOf([], seen, status)).toEqual([]);
});

test('the search finds what has all the words', () => {
  const texts = (one: string) => [one, 'x'];
  expect(withAllWords(['/scan', '/Scan/front', '/map'], ' scan  X', texts)).toEqual(['/scan', '/Scan/front']);
  expect(withAllWords(['/scan'], ' ', texts)).toEqual(['/scan']);
});

test('qualities, limits and values are said as by the command', () => {
  expect(qualityText({ reliability: 'best_effort', durability: 'volatile', deadline: '100ms' })).toBe('best_effort, volatile, deadline 100ms');
  const rate = { name: 'rate', kind: 'integer', value: 10, read_only: true, description: '', constraints: 'even', range: { from: 1, to: 40, step: 2 } };
  expect(limitsText(rate)).toBe('read-only, 1 to 40, step 2, even');
  expect(limitsText({ ...rate, read_only: false, constraints: '', range: { from: 0, to: 0.5, step: 0 } })).toBe('0 to 0.5');
  expect(limitsText({ ...rate, read_only: false, constraints: '', range: undefined })).toBe('');
  expect([valueText('<b>'), valueText([1, true]), valueText(null)]).toEqual(['<b>', '[1,true]', 'null']);
});

test('a process is named by its package, where that is known', () => {
  expect(processText(node('/a'))).toContain('not known');
  expect(processText(node('/a', { process: process(7, 'talker') }))).toBe('talker (7)');
  expect(processText(node('/a', { process: { pid: 7, nodes: 3, program: 'x', package: 'demo', executable: 'talker' } }))).toBe('demo talker (7), with 3 nodes');
});

test('what is not known of a node is said', () => {
  expect(notesOf(node('/a'))).toEqual([]);
  expect(notesOf(node('/a', { copies: 2, unseen_endpoints: 3, problems: ['it is silent'] }))).toEqual(['2 nodes have this name', '3 of its topics or services have not been found in time', 'it is silent']);
});

test('a mismatch says who gets nothing, and why', () => {
  expect(mismatchText({ publisher: '/lidar', subscription: '', reasons: ['a', 'b'] })).toBe('a program that is not a node gets nothing from /lidar: a; b');
});

test('a place is named', () => {
  expect([placeText({ domain: -1, discovery: '' }), placeText({ domain: 7, discovery: 'localhost' })]).toEqual(['the domain of the environment', 'domain 7, localhost']);
});

test('an answer of another kind is none', () => {
  expect([seenIn(null), seenIn({ nodes: [], topics: [] }), seenIn({ nodes: {}, topics: [], tasks: {} })]).toEqual([null, null, null]);
  expect(seenIn({ nodes: [], topics: [], tasks: {} })).not.toBeNull();
});
