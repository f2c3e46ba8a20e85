// SPDX-License-Identifier: Apache-2.0
import { Box3, LineBasicMaterial, Points, Vector3, type Line, type Object3D } from 'three';
import { describe, expect, it } from 'vitest';
import type { Scene } from './draw_map';
import { dispose, spaceOf } from './space_scene';

const scene: Scene = {
  grids: [], trails: [[{ x: 0, y: 0 }, { x: 3, y: 4 }]], paths: [[{ x: 3, y: 4 }, { x: 5, y: 4 }]],
  scans: [{ from: { x: 3, y: 4, theta: 0 }, points: [{ x: 6, y: 4 }, { x: 3, y: 9 }] }],
  poses: [{ x: 3, y: 4, theta: Math.PI / 2 }, { x: -1, y: -1, theta: 0 }],
};

const all = (space: Object3D, fits: (part: Object3D) => boolean) => {
  const found: Object3D[] = [];
  space.traverse((part) => fits(part) && found.push(part));
  return found;
};

describe('the shapes in 3D', () => {
  it('are where the samples are', () => {
    const space = spaceOf(scene, false, { x: 0, y: 0 }, 10);
    const [scan] = all(space, (part) => part instanceof Points);
    const seen = new Box3().setFromObject(scan!);
    expect(seen.min.x).toBeCloseTo(3);
    expect(seen.max.y).toBeCloseTo(9);
    const rover = space.children.find((child) => child.children.length === 8)!;
    expect(rover.position).toEqual(new Vector3(3, 4, 0));
    const size = new Box3().setFromObject(rover).getSize(new Vector3());
    expect(size.y, 'it looks along y').toBeGreaterThan(size.x);
    expect(space.children.filter((child) => child.children.length === 6), 'the frames of the origin and of both poses').toHaveLength(3);
  });

  it('have other colours where it is dark', () => {
    const pathOf = (isDark: boolean) => {
      const [, path] = spaceOf(scene, isDark, { x: 0, y: 0 }, 10).children.filter((child) => child.type === 'Line') as Line[];
      return (path!.material as LineBasicMaterial).color.getHexString();
    };
    expect(pathOf(false)).toBe('0b6b49');
    expect(pathOf(true)).toBe('6fd3a8');
  });

  it('are freed', () => {
    const space = spaceOf(scene, false, { x: 0, y: 0 }, 10);
    let freed = 0;
    space.traverse((part) => (part as Partial<Line>).geometry?.addEventListener('dispose', () => ++freed));
    dispose(space);
    expect(freed).toBe(all(space, (part) => (part as Partial<Line>).geometry !== undefined).length);
  });
});
