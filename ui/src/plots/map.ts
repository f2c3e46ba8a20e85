// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json } from '../robot/change';
import { isNumber } from './fields';

export interface Pose {
  x: number;
  y: number;
  theta: number;
}
export interface Point {
  x: number;
  y: number;
}

/** The part of the plane that a map shows: `centre` in metres, `scale` in pixels a metre; y is upward. */
export interface View {
  x: number;
  y: number;
  scale: number;
}

const smallestScale = 0.05;
const largestScale = 5000;

/** A pose in words. */
export function poseText(pose: Pose): string {
  return 'x ' + pose.x.toFixed(2) + ' m, y ' + pose.y.toFixed(2) + ' m, ' + ((pose.theta * 180) / Math.PI).toFixed(0) + '°';
}

export function poseOf(value: Json | undefined): Pose | null {
  if (!isMap(value) || !isNumber(value['x']) || !isNumber(value['y'])) return null;
  return { x: value['x'], y: value['y'], theta: isNumber(value['theta']) ? value['theta'] : 0 };
}

/** Points where a scan met something, seen from `pose`. Ranges that are infinite or beyond the scan's limits met nothing. */
export function scanPoints(value: Json | undefined, pose: Pose): Point[] {
  if (!isMap(value) || !Array.isArray(value['ranges'])) return [];
  const first = isNumber(value['first_angle']) ? value['first_angle'] : 0;
  const step = isNumber(value['angle_step']) ? value['angle_step'] : isNumber(value['step']) ? value['step'] : 0;
  const least = isNumber(value['minimum_range']) ? value['minimum_range'] : 0;
  const most = isNumber(value['maximum_range']) && value['maximum_range'] > 0 ? value['maximum_range'] : Infinity;
  return value['ranges'].flatMap((range, index) => {
    if (!isNumber(range) || range < least || range > most) return [];
    const angle = pose.theta + first + index * step;
    return [{ x: pose.x + range * Math.cos(angle), y: pose.y + range * Math.sin(angle) }];
  });
}

export interface Grid {
  x: number;
  y: number;
  resolution: number;
  width: number;
  height: number;
  cells: (number | null)[];
}

const mostPixels = 1 << 24;

/** Null where the numbers do not fit each other. */
export function gridOf(value: Json | undefined): Grid | null {
  if (!isMap(value)) return null;
  const grid = value as unknown as Grid;
  if (![grid.x, grid.y, grid.resolution, grid.width, grid.height].every(isNumber) || !Array.isArray(grid.cells)) return null;
  const cells = grid.width * grid.height;
  return grid.resolution > 0 && cells > 0 && cells <= mostPixels && cells === grid.cells.length ? grid : null;
}

/** RGBA from the top, so the row with the largest y first; unknown cells are transparent. */
export function gridPixels(grid: Grid, free: number[], occupied: number[]): Uint8ClampedArray {
  const pixels = new Uint8ClampedArray(4 * grid.width * grid.height);
  for (let row = 0; row < grid.height; ++row) {
    for (let column = 0; column < grid.width; ++column) {
      const cell = grid.cells[row * grid.width + column] ?? -1;
      if (cell < 0) continue;
      const at = 4 * ((grid.height - 1 - row) * grid.width + column);
      for (let part = 0; part < 3; ++part) pixels[at + part] = (free[part] ?? 0) + ((occupied[part] ?? 0) - (free[part] ?? 0)) * Math.min(1, cell / 100);
      pixels[at + 3] = 255;
    }
  }
  return pixels;
}

/** RGBA of an image of three bytes a pixel, or what is wrong with it. */
export function imagePixels(value: Json | undefined): { width: number; height: number; pixels: Uint8ClampedArray } | string {
  if (!isMap(value)) return 'the sample is not an image';
  const { width, height, rgb } = value as { width?: Json; height?: Json; rgb?: Json };
  if (!isNumber(width) || !isNumber(height) || !Array.isArray(rgb)) return 'the sample is not an image: it has no width, height and rgb';
  if (width === 0 || height === 0) return 'the image is empty';
  if (!Number.isInteger(width) || !Number.isInteger(height) || width < 0 || height < 0 || width * height > mostPixels)
    return 'the image is said to have ' + width + ' × ' + height + ' pixels';
  if (rgb.length !== 3 * width * height) return 'an image of ' + width + ' × ' + height + ' pixels has ' + 3 * width * height + ' bytes, not ' + rgb.length;
  const pixels = new Uint8ClampedArray(4 * width * height);
  for (let pixel = 0, from = 0, to = 0; pixel < width * height; ++pixel) {
    pixels[to++] = rgb[from++] as number;
    pixels[to++] = rgb[from++] as number;
    pixels[to++] = rgb[from++] as number;
    pixels[to++] = 255;
  }
  return { width, height, pixels };
}

/** Where a point of the plane is on a canvas of that size. */
export function toCanvas(view: View, width: number, height: number, point: Point): Point {
  return { x: width / 2 + (point.x - view.x) * view.scale, y: height / 2 - (point.y - view.y) * view.scale };
}
export function fromCanvas(view: View, width: number, height: number, point: Point): Point {
  return { x: view.x + (point.x - width / 2) / view.scale, y: view.y - (point.y - height / 2) / view.scale };
}

/** `factor` times as large; the point of the plane at `at` stays where it is on the canvas. */
export function zoomed(view: View, factor: number, at: Point): View {
  const scale = Math.min(largestScale, Math.max(smallestScale, view.scale * factor));
  const kept = view.scale / scale;
  return { x: at.x + (view.x - at.x) * kept, y: at.y + (view.y - at.y) * kept, scale };
}

/** Shows all points with some room around them; null: there are none. */
export function viewOf(points: Point[], width: number, height: number): View | null {
  if (points.length === 0) return null;
  let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const { x, y } of points) {
    left = Math.min(left, x);
    right = Math.max(right, x);
    low = Math.min(low, y);
    high = Math.max(high, y);
  }
  const scale = Math.min(width / Math.max(1, (right - left) * 1.15), height / Math.max(1, (high - low) * 1.15));
  return { x: (left + right) / 2, y: (low + high) / 2, scale: Math.min(largestScale, Math.max(smallestScale, scale)) };
}

/** 1, 2 or 5 times a power of ten: a length of `pixels` or a bit more. */
export function roundLength(view: View, pixels: number): number {
  const least = pixels / view.scale;
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((times) => times * power).find((length) => length >= least * 0.999) ?? 10 * power;
}
