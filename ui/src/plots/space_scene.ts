// SPDX-License-Identifier: Apache-2.0
import {
  AmbientLight, BoxGeometry, BufferGeometry, CanvasTexture, Color, ConeGeometry, CylinderGeometry, DirectionalLight, Group, GridHelper, Line, LineBasicMaterial, LineSegments,
  Material, Mesh, MeshBasicMaterial, MeshLambertMaterial, NearestFilter, Object3D, PlaneGeometry, Points, PointsMaterial, SRGBColorSpace, Vector3,
} from 'three';
import { coloursOf, pictureOf, type Scene } from './draw_map';
import type { Grid, Point, Pose } from './map';

/** Heights in metres, so that what lies in the plane is not in one plane. */
const heights = { grid: -0.01, trail: 0.02, path: 0.04, scan: 0.25 };
const axisColours = { light: ['#b3261e', '#0b6b49', '#1f5fd0'], dark: ['#ff9d95', '#6fd3a8', '#82aefc'] };

const points3 = (points: Point[], z: number) => new BufferGeometry().setFromPoints(points.map(({ x, y }) => new Vector3(x, y, z)));

function lineOf(points: Point[], z: number, colour: string): Object3D {
  return new Line(points3(points, z), new LineBasicMaterial({ color: colour }));
}

/** The axes of a frame: x red, y green, z blue, with a tip each. */
function frameOf(pose: Pose, length: number, isDark: boolean): Object3D {
  const frame = new Group();
  const directions = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];
  (isDark ? axisColours.dark : axisColours.light).forEach((color, index) => {
    const direction = directions[index] as Vector3;
    const end = direction.clone().multiplyScalar(length);
    frame.add(new LineSegments(new BufferGeometry().setFromPoints([new Vector3(), end]), new LineBasicMaterial({ color })));
    const tip = new Mesh(new ConeGeometry(length * 0.06, length * 0.2, 10), new MeshBasicMaterial({ color }));
    tip.position.copy(end);
    tip.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), direction);
    frame.add(tip);
  });
  frame.position.set(pose.x, pose.y, 0);
  frame.rotation.z = pose.theta;
  return frame;
}

/** A rover of boxes and wheels, half a metre long, that looks along x. */
function roverOf(pose: Pose, colour: string, dark: string): Object3D {
  const rover = new Group();
  const body = new Mesh(new BoxGeometry(0.5, 0.3, 0.12), new MeshLambertMaterial({ color: colour }));
  body.position.z = 0.2;
  const mast = new Mesh(new BoxGeometry(0.06, 0.06, 0.18), new MeshLambertMaterial({ color: colour }));
  mast.position.set(0.18, 0, 0.34);
  rover.add(body, mast);
  for (const x of [-0.18, 0, 0.18]) {
    for (const y of [-0.2, 0.2]) {
      const wheel = new Mesh(new CylinderGeometry(0.08, 0.08, 0.07, 18), new MeshLambertMaterial({ color: dark }));
      wheel.position.set(x, y, 0.08);
      rover.add(wheel);
    }
  }
  rover.position.set(pose.x, pose.y, 0);
  rover.rotation.z = pose.theta;
  return rover;
}

function gridOf(grid: Grid, isDark: boolean): Object3D {
  const [width, height] = [grid.width * grid.resolution, grid.height * grid.resolution];
  const map = new CanvasTexture(pictureOf(grid, isDark));
  map.colorSpace = SRGBColorSpace;
  map.magFilter = NearestFilter;
  const plane = new Mesh(new PlaneGeometry(width, height), new MeshBasicMaterial({ map, transparent: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
  plane.position.set(grid.x + width / 2, grid.y + height / 2, heights.grid);
  return plane;
}

/** Lines on the ground, a metre or ten apart, around a point. */
function groundAt(at: Point, distance: number, isDark: boolean): Object3D {
  const step = distance > 60 ? 10 : 1;
  const { lines } = coloursOf(isDark);
  const ground = new GridHelper(step * 40, 40, lines, lines);
  ground.rotation.x = Math.PI / 2;
  ground.position.set(Math.round(at.x / step) * step, Math.round(at.y / step) * step, -0.02);
  return ground;
}

/** The shapes of a scene in 3D, in metres, z upward: the first pose is that of the rover, all poses have their frames, and so has the origin. */
export function spaceOf(scene: Scene, isDark: boolean, at: Point, distance: number): Group {
  const colours = coloursOf(isDark);
  const space = new Group();
  space.add(new AmbientLight('#ffffff', 1.8));
  const sun = new DirectionalLight('#ffffff', 1.6);
  sun.position.set(3, -4, 8);
  space.add(sun, groundAt(at, distance, isDark), frameOf({ x: 0, y: 0, theta: 0 }, 1, isDark));
  for (const grid of scene.grids) space.add(gridOf(grid, isDark));
  for (const trail of scene.trails) space.add(lineOf(trail, heights.trail, colours.trail));
  for (const path of scene.paths) space.add(lineOf(path, heights.path, colours.path));
  for (const scan of scene.scans) space.add(new Points(points3(scan.points, heights.scan), new PointsMaterial({ color: colours.scan, size: 4, sizeAttenuation: false })));
  scene.poses.forEach((pose, index) => {
    if (index === 0) space.add(roverOf(pose, colours.pose, new Color(colours.text).getStyle()));
    space.add(frameOf(pose, 0.6, isDark));
  });
  return space;
}

/** Frees what the graphics card holds of shapes. */
export function dispose(space: Object3D): void {
  space.traverse((part) => {
    const { geometry, material } = part as Partial<Mesh>;
    geometry?.dispose();
    for (const one of material instanceof Material ? [material] : (material ?? [])) {
      (one as MeshBasicMaterial).map?.dispose();
      one.dispose();
    }
  });
}
