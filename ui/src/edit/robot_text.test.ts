// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { forgetFile, isNamed, nameFile, renameFile } from './robot_text';

const robot = 'robot: r   # mine\ncontrollers: [controllers/*.yaml, a.yaml]   # all\nmissions:\n  - fetch.yaml   # one\n';

it('a robot file names files by patterns', () => {
  expect(isNamed(robot, 'controllers', 'controllers/x.yaml')).toBe(true);
  expect(isNamed(robot, 'controllers', 'controllers/in/x.yaml')).toBe(false);
  expect(isNamed(robot, 'controllers', 'aXyaml')).toBe(false);
  expect(isNamed('robot: r\n', 'missions', 'fetch.yaml')).toBe(false);
});
it('files are named, renamed and forgotten', () => {
  expect(nameFile(robot, 'controllers', 'controllers/x.yaml')).toBe(robot);
  expect(nameFile(robot, 'controllers', 'b.yaml')).toBe(robot.replace('a.yaml]', 'a.yaml, b.yaml]'));
  expect(nameFile('robot: r\n', 'controllers', 'b.yaml')).toBe('robot: r\ncontrollers:\n  - b.yaml\n');
  expect(renameFile(robot, 'controllers', 'a.yaml', 'b.yaml')).toBe(robot.replace('a.yaml', 'b.yaml'));
  expect(renameFile(robot, 'controllers', 'a.yaml', 'controllers/a.yaml')).toBe(robot.replace(', a.yaml', ''));
  expect(renameFile(robot, 'controllers', 'controllers/x.yaml', 'b.yaml')).toBe(robot.replace('a.yaml]', 'a.yaml, b.yaml]'));
  expect(renameFile(robot, 'missions', 'other.yaml', 'b.yaml')).toBe(robot);
  expect(renameFile(robot, 'missions', 'fetch.yaml', 'b.yaml')).toBe(robot.replace('fetch.yaml', 'b.yaml'));
  expect(forgetFile(robot, 'controllers', 'a.yaml')).toBe(robot.replace(', a.yaml', ''));
  expect(forgetFile(robot, 'controllers', 'controllers/x.yaml')).toBe(robot);
});
