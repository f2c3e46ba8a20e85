// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';
import { addressOf, restOfAddress } from './address';

test('what is for a view comes back as it was', () => {
  for (const rest of ['/robot/lidar', 'a b#%', 'front.lidar']) expect(restOfAddress(addressOf('ros2', rest), 'ros2')).toBe(rest);
});

test('addresses of other views, and broken ones, have nothing for it', () => {
  expect(['#ros2', '#ros2/', '#ros22/x', '#network/x', '#ros2/%', ''].map((hash) => restOfAddress(hash, 'ros2'))).toEqual(['', '', '', '', '', '']);
});
