// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { cameraOf, fieldOfView, fitted, moved, nearer, orbitAtFirst, turned, type Orbit } from './orbit';

const level: Orbit = { target: { x: 1, y: 2, z: 0 }, yaw: 0, pitch: 0, distance: 10 };

describe('a camera in orbit', () => {
  it('is where its angles say', () => {
    expect(cameraOf(level)).toEqual({ x: 11, y: 2, z: 0 });
    const above = cameraOf({ ...level, pitch: Math.PI / 2 });
    expect(above.x).toBeCloseTo(1);
    expect(above.z).toBeCloseTo(10);
  });

  it('turns around its target, but not over the top or far below the ground', () => {
    expect(turned(level, 1, 0.5)).toMatchObject({ yaw: 1, pitch: 0.5, target: level.target });
    expect(turned(level, 0, 9).pitch).toBeLessThan(Math.PI / 2);
    expect(turned(level, 0, -9).pitch).toBeGreaterThan(-0.5);
  });

  it('comes nearer and goes away within limits', () => {
    expect(nearer(level, 2).distance).toBe(5);
    expect(nearer(level, 1e9).distance).toBeGreaterThan(0.1);
    expect(nearer(level, 1e-9).distance).toBeLessThan(1e4);
  });

  it('moves as it is seen', () => {
    // The camera is at the side of x and looks back along it: to its right is y, forward is -x.
    expect(moved(level, 0.1, 0).target).toEqual({ x: 1, y: 3, z: 0 });
    expect(moved(level, 0, 0.1).target).toEqual({ x: 0, y: 2, z: 0 });
  });

  it('sees all points', () => {
    expect(fitted(level, [], 2)).toBe(level);
    const points = [{ x: -4, y: 0 }, { x: 8, y: 10 }, { x: 0, y: -6 }];
    for (const aspect of [0.5, 1, 3]) {
      const orbit = fitted(orbitAtFirst, points, aspect);
      expect(orbit.target).toEqual({ x: 2, y: 2, z: 0 });
      const camera = cameraOf(orbit);
      const narrow = Math.min(fieldOfView * Math.PI / 360, Math.atan(Math.tan(fieldOfView * Math.PI / 360) * aspect));
      for (const point of points) {
        const toPoint = [point.x - camera.x, point.y - camera.y, -camera.z];
        const toTarget = [2 - camera.x, 2 - camera.y, -camera.z];
        const dot = toPoint.reduce((sum, part, index) => sum + part * toTarget[index]!, 0);
        expect(Math.acos(dot / Math.hypot(...toPoint) / Math.hypot(...toTarget))).toBeLessThan(narrow);
      }
    }
  });
});
