// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { fieldsOf, fits, pathText, shapeOf, suggestedKind, valueAt } from './fields';

const odometry = { time: 1.5, pose: { x: 1, y: 2, theta: 0.5 }, twist: { linear: 0.1, angular: 0 } };

describe('fields', () => {
  it('are found with what they can be shown as', () => {
    expect(fieldsOf(odometry).map((field) => [pathText(field.path), field.shape])).toEqual([
      ['time', 'number'], ['pose', 'pose'], ['pose.x', 'number'], ['pose.y', 'number'], ['pose.theta', 'number'],
      ['twist.linear', 'number'], ['twist.angular', 'number'],
    ]);
    expect(fieldsOf(3)).toEqual([{ path: [], shape: 'number', size: 1 }]);
    expect(fieldsOf('text')).toEqual([]);
  });
  it('know messages by their form', () => {
    expect(shapeOf({ time: 0, width: 1, height: 1, rgb: [1, 2, 3] })).toBe('image');
    expect(shapeOf({ first_angle: -1, angle_step: 0.1, ranges: [1, null] })).toBe('scan');
    expect(shapeOf({ first_angle: -1, step: 0.1, ranges: [] })).toBe('scan');
    expect(shapeOf({ resolution: 1, x: 0, y: 0, width: 1, height: 1, cells: [-1] })).toBe('grid');
    expect(shapeOf({ poses: [] })).toBe('path');
    expect(shapeOf({ outcome: 'found', points: [{ x: 0, y: 1 }], length: 1 })).toBe('path');
    expect(shapeOf([{ x: 0, y: 1 }])).toBe('path');
    expect(shapeOf([1, null, 2])).toBe('numbers');
    expect(shapeOf([])).toBeNull();
    expect(shapeOf([1, 'a'])).toBeNull();
  });
  it('of long lists and of images are not listed one by one', () => {
    expect(fieldsOf({ ranges: new Array<number>(360).fill(1) })).toHaveLength(1);
    expect(fieldsOf({ width: 1, height: 1, rgb: [1, 2, 3] })).toHaveLength(1);
    expect(fieldsOf([7, 8]).map((field) => pathText(field.path))).toEqual(['', '[0]', '[1]']);
  });
  it('suggest the panel that fits', () => {
    const kinds = (value: Parameters<typeof fieldsOf>[0]) => suggestedKind(fieldsOf(value)[0]!);
    expect(kinds(1)).toBe('time');
    expect(kinds([1, 2, 3])).toBe('time');
    expect(kinds(new Array<number>(60).fill(0))).toBe('profile');
    expect(kinds({ x: 1, y: 2 })).toBe('map');
    expect(kinds({ width: 1, height: 1, rgb: [] })).toBe('image');
    expect(fits('map', 'scan')).toBe(true);
    expect(fits('time', 'scan')).toBe(false);
  });
  it('are parts of samples, and nothing that objects have by themselves', () => {
    expect(valueAt(odometry, ['pose', 'x'])).toBe(1);
    expect(valueAt([4, 5], ['1'])).toBe(5);
    expect(valueAt(odometry, [])).toBe(odometry);
    for (const path of [['pose', 'z'], ['constructor'], ['__proto__'], ['time', 'x']]) expect(valueAt(odometry, path)).toBeUndefined();
    expect(valueAt([4, 5], ['length'])).toBeUndefined();
  });
});
