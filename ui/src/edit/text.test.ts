// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { addConnection, addTask, addWrittenTask, networkIn, removeConnection, removeProperty, removeTask, renameTask, setProperty } from './text';

const network = `# Wanders about.
network: explore

tasks:
  drive: {component: "demo::Drive"}   # the wheels
  # sees
  laser:
    component: "demo::LaserScanner"
    properties:
      beams: 32   # few

  wanderer: {component: 'demo::Wanderer', properties: {speed:   0.4, names: [a, "b"]}}

connections:
  - laser.scan -> wanderer.scan   # what it sees
  - {from: wanderer.command, to: drive.command, policy: buffer, size: 4}
deployments:
  eyes: {tasks: [laser, other]}   # apart
# the end
`;

/** Lines that are only in one of the texts. */
function difference(before: string, after: string): string[] {
  const old = before.split('\n');
  const now = after.split('\n');
  return [...old.filter((line) => !now.includes(line)).map((line) => '-' + line), ...now.filter((line) => !old.includes(line)).map((line) => '+' + line)];
}

describe('networkIn', () => {
  it('finds tasks, their places and connections', () => {
    const found = networkIn(network);
    expect(found?.editable).toBe(true);
    expect(found?.tasks.map((task) => [task.id, task.component, task.place])).toEqual([
      ['drive', 'demo::Drive', ''], ['laser', 'demo::LaserScanner', 'eyes'], ['wanderer', 'demo::Wanderer', ''],
    ]);
    expect(found?.connections.map((one) => one && one.from + ' ' + one.to)).toEqual(['laser.scan wanderer.scan', 'wanderer.command drive.command']);
    expect(network.slice(found?.tasks[1]?.at).startsWith('laser:')).toBe(true);
  });
  it('finds nothing in broken texts and in other files', () => {
    for (const text of ['', 'network: [', '[1, 2]', 'robot: rover\n', 'tasks: *nothing\n']) expect(networkIn(text)).toBeNull();
    expect(networkIn('tasks:\n  a: {type: "t::A"}\nconnections:\n  c: {from: x}\n')?.editable).toBe(false);
  });
});

describe('edits touch nothing else', () => {
  it('adds a task', () => {
    expect(difference(network, addTask(network, 'guard', 'demo::ObstacleStop'))).toEqual(['+  guard: {component: "demo::ObstacleStop"}']);
    expect(addTask('network: a\n', 'x', 't::X')).toBe('network: a\ntasks:\n  x: {component: "t::X"}\n');
    expect(addTask('network: a\ntasks: {}  # none\n', 'x', 't::X')).toBe('network: a\ntasks:  # none\n  x: {component: "t::X"}\n');
    expect(addTask('network: a\ntasks: {y: {component: t::Y}}', 'x', 't::X')).toBe('network: a\ntasks: {y: {component: t::Y}, x: {component: "t::X"}}');
    expect(addTask('network: a\ntasks:\n  y: {component: t::Y}', 'x', 't::X')).toBe('network: a\ntasks:\n  y: {component: t::Y}\n  x: {component: "t::X"}');
    expect(() => addTask(network, 'laser', 't::X')).toThrow('already');
    expect(() => addTask('network: [', 'laser', 't::X')).toThrow('parsed');
  });
  it('adds a task as it is written elsewhere', () => {
    const written = '# Begins with this.\ntasks:\n  # of a node\n  laser:\n    component: ros2::Node\n    properties:\n      name: /laser\n      publishes: {scan: std_msgs/msg/UInt64}\n      text: "a\\nb"\n';
    const { id, text } = addWrittenTask(network, written);
    expect(id).toBe('laser_2');
    expect(difference(network, text)).toEqual(['+  laser_2:', '+    component: ros2::Node', '+      name: /laser', '+      publishes: {scan: std_msgs/msg/UInt64}', '+      text: "a\\nb"']);
    expect(networkIn(text)?.tasks.find((task) => task.id === id)?.properties).toEqual({ name: '/laser', publishes: { scan: 'std_msgs/msg/UInt64' }, text: 'a\nb' });
    expect(addWrittenTask('network: a\ntasks: {y: {component: t::Y}}', 'tasks:\n  x:\n    component: t::X\n    properties: {}\n').text).toContain('x: {component: t::X, properties: {}}');
    expect(() => addWrittenTask('robot: rover\n', written)).toThrow('as text only');
    expect(() => addWrittenTask(network, 'tasks: {}')).toThrow('no task');
  });
  it('adds a connection', () => {
    expect(difference(network, addConnection(network, 'laser.scan', 'drive.scan'))).toEqual(['+  - laser.scan -> drive.scan']);
    expect(addConnection('network: a\nconnections: []\n', 'a.b', 'c.d')).toBe('network: a\nconnections:\n  - a.b -> c.d\n');
    expect(addConnection('network: a\nconnections: [a.b -> c.d]\n', 'a.b', 'c.e')).toBe('network: a\nconnections: [a.b -> c.d, a.b -> c.e]\n');
    expect(addConnection('network: a\nconnections:\n- a.b -> c.d\ntasks: {}\n', 'a.b', 'c.e')).toBe('network: a\nconnections:\n- a.b -> c.d\n- a.b -> c.e\ntasks: {}\n');
  });
  it('removes a connection', () => {
    expect(difference(network, removeConnection(network, 0))).toEqual(['-  - laser.scan -> wanderer.scan   # what it sees']);
    expect(removeConnection('network: a\nconnections:\n  - a.b -> c.d\n', 0)).toBe('network: a\nconnections: []\n');
    expect(removeConnection('network: a\nconnections: [a.b -> c.d, a.b -> c.e]\n', 0)).toBe('network: a\nconnections: [a.b -> c.e]\n');
  });
  it('removes a task with its connections and its place', () => {
    expect(difference(network, removeTask(network, 'laser'))).toEqual([
      '-  laser:', '-    component: "demo::LaserScanner"', '-    properties:', '-      beams: 32   # few',
      '-  - laser.scan -> wanderer.scan   # what it sees', '-  eyes: {tasks: [laser, other]}   # apart', '+  eyes: {tasks: [other]}   # apart',
    ]);
    expect(removeTask('network: a\ntasks:\n  x: {component: t::X}\n', 'x')).toBe('network: a\ntasks: {}\n');
  });
  it('sets a property', () => {
    expect(difference(network, setProperty(network, 'laser', 'beams', '64'))).toEqual(['-      beams: 32   # few', '+      beams: 64   # few']);
    expect(difference(network, setProperty(network, 'laser', 'range', '1.5'))).toEqual(['+      range: 1.5']);
    expect(difference(network, setProperty(network, 'drive', 'max', '[1, 2]'))).toEqual([
      '-  drive: {component: "demo::Drive"}   # the wheels', '+  drive: {component: "demo::Drive", properties: {max: [1, 2]}}   # the wheels',
    ]);
    expect(setProperty(network, 'wanderer', 'speed', '0.5')).toContain('properties: {speed:   0.5, names: [a, "b"]}}');
    const comma = setProperty(network, 'wanderer', 'speed', 'a, b');
    expect(networkIn(comma)?.tasks[2]?.properties['speed']).toBe('a, b');
    expect(comma).toContain('# few');
    expect(() => setProperty(network, 'laser', 'beams', '[')).toThrow();
  });
  it('removes a property', () => {
    expect(difference(network, removeProperty(network, 'laser', 'beams'))).toEqual(['-    properties:', '-      beams: 32   # few']);
    expect(removeProperty(network, 'wanderer', 'speed')).toContain('properties: {names: [a, "b"]}}');
  });
  it('renames a task with its connections and its place', () => {
    expect(difference(network, renameTask(network, 'laser', 'eye'))).toEqual([
      '-  laser:', '-  - laser.scan -> wanderer.scan   # what it sees', '-  eyes: {tasks: [laser, other]}   # apart',
      '+  eye:', '+  - eye.scan -> wanderer.scan   # what it sees', '+  eyes: {tasks: [eye, other]}   # apart',
    ]);
    expect(difference(network, renameTask(network, 'drive', 'wheels'))).toEqual([
      '-  drive: {component: "demo::Drive"}   # the wheels', '-  - {from: wanderer.command, to: drive.command, policy: buffer, size: 4}',
      '+  wheels: {component: "demo::Drive"}   # the wheels', '+  - {from: wanderer.command, to: wheels.command, policy: buffer, size: 4}',
    ]);
    expect(renameTask(network, 'laser', 'laser')).toBe(network);
    expect(() => renameTask(network, 'laser', 'drive')).toThrow('already');
    for (const name of ['', 'a b', 'a.b', '{x}']) expect(() => renameTask(network, 'laser', name)).toThrow('named by');
  });
  it('keeps anchors that others need', () => {
    const shared = 'network: a\ntasks:\n  x: &x {component: t::X}\n  y: *x\n';
    expect(() => setProperty(shared, 'y', 'p', '1')).toThrow('alias');
  });
});
