// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { arrowOf, labelPlace, pathOf } from './route';

describe('the route of an edge', () => {
  it('goes through its points with rounded corners', () => {
    expect(pathOf([{ x: 0, y: 0 }, { x: 20, y: 0 }, { x: 20, y: 30 }])).toBe('M 0.0 0.0 L 14.0 0.0 Q 20.0 0.0 20.0 6.0 L 20.0 30.0');
  });
  it('has smaller corners where parts are short', () => {
    expect(pathOf([{ x: 0, y: 0 }, { x: 4, y: 0 }, { x: 4, y: 30 }])).toContain('L 2.0 0.0 Q 4.0 0.0 4.0 2.0');
  });
  it('stays a path where points coincide', () => {
    expect(pathOf([{ x: 1, y: 1 }, { x: 1, y: 1 }, { x: 1, y: 1 }])).not.toContain('NaN');
  });
  it('has its label on its longest level part', () => {
    expect(labelPlace([{ x: 0, y: 0 }, { x: 10, y: 0 }, { x: 10, y: 90 }, { x: 50, y: 90 }])).toEqual({ x: 30, y: 90 });
    expect(labelPlace([{ x: 0, y: 0 }, { x: 0, y: 40 }])).toEqual({ x: 0, y: 20 });
  });
  it('ends with an arrow that points along its last part', () => {
    expect(arrowOf([{ x: 0, y: 0 }, { x: 20, y: 0 }])).toBe('M 20.0 0.0 L 13.0 3.5 L 13.0 -3.5 Z');
    expect(arrowOf([{ x: 0, y: 0 }])).toBe('');
  });
});
