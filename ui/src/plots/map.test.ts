// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { fromCanvas, gridOf, gridPixels, imagePixels, poseOf, roundLength, scanPoints, toCanvas, viewOf, zoomed } from './map';

describe('maps', () => {
  it('place scans in the frame of a pose', () => {
    const scan = { first_angle: -Math.PI / 2, angle_step: Math.PI / 2, minimum_range: 0.1, maximum_range: 5, ranges: [1, 2, null] };
    const [right, ahead, ...others] = scanPoints(scan, { x: 1, y: 1, theta: Math.PI / 2 });
    expect(right!.x).toBeCloseTo(2);
    expect(right!.y).toBeCloseTo(1);
    expect(ahead!.x).toBeCloseTo(1);
    expect(ahead!.y).toBeCloseTo(3);
    expect(others).toEqual([]);
    expect(scanPoints({ ...scan, ranges: [0, 6, 'a'] }, { x: 0, y: 0, theta: 0 })).toEqual([]);
    expect(scanPoints(null, { x: 0, y: 0, theta: 0 })).toEqual([]);
  });
  it('read poses', () => {
    expect(poseOf({ x: 1, y: 2 })).toEqual({ x: 1, y: 2, theta: 0 });
    expect(poseOf({ x: 1, y: 'a' })).toBeNull();
  });
  it('draw grids with the first row below', () => {
    const grid = gridOf({ x: 0, y: 0, resolution: 1, width: 1, height: 2, cells: [100, -1] })!;
    expect([...gridPixels(grid, [255, 255, 255], [0, 0, 0])]).toEqual([0, 0, 0, 0, 0, 0, 0, 255]);
    expect(gridOf({ ...grid, width: 2 } as never)).toBeNull();
    expect(gridOf({ ...grid, width: 1e9, height: 1e9 } as never)).toBeNull();
  });
  it('read images, and say what is wrong with others', () => {
    expect(imagePixels({ width: 2, height: 1, rgb: [1, 2, 3, 4, 5, 6] })).toEqual({ width: 2, height: 1, pixels: new Uint8ClampedArray([1, 2, 3, 255, 4, 5, 6, 255]) });
    expect(imagePixels({ width: 2, height: 2, rgb: [1] })).toContain('has 12 bytes, not 1');
    expect(imagePixels({ width: 1e6, height: 1e6, rgb: [] })).toContain('1000000');
    expect(imagePixels({ width: 0, height: 0, rgb: [] })).toContain('empty');
    expect(imagePixels(7)).toContain('not an image');
  });
  it('keep the point under the cursor when zoomed', () => {
    const view = { x: 1, y: 2, scale: 50 };
    const at = fromCanvas(view, 400, 300, { x: 30, y: 40 });
    const after = toCanvas(zoomed(view, 3, at), 400, 300, at);
    expect(after.x).toBeCloseTo(30);
    expect(after.y).toBeCloseTo(40);
  });
  it('show all points', () => {
    const view = viewOf([{ x: -2, y: 0 }, { x: 4, y: 1 }], 600, 300)!;
    expect(view.x).toBe(1);
    expect(toCanvas(view, 600, 300, { x: 4, y: 1 }).x).toBeLessThan(600);
    expect(viewOf([], 600, 300)).toBeNull();
    expect(roundLength({ x: 0, y: 0, scale: 40 }, 60)).toBe(2);
    expect(roundLength({ x: 0, y: 0, scale: 1000 }, 60)).toBeCloseTo(0.1);
  });
});
