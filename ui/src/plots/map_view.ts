// SPDX-License-Identifier: Apache-2.0
import type { Json } from '../robot/change';
import { drawScene, type Scene } from './draw_map';
import { pointsOf, shapeOf, valueAt } from './fields';
import { documentOf, type Panel } from './layout';
import { fromCanvas, gridOf, poseOf, scanPoints, toCanvas, viewOf, zoomed, type Point, type Pose, type View } from './map';

interface Past {
  time: number;
  pose: Pose;
}

/** A pose that moved less than this is not a new point of its trail. */
const leastStep = 0.005;

function emptyScene(): Scene {
  return { grids: [], paths: [], scans: [], trails: [], poses: [] };
}

/** The shapes of the sources' newest samples, scans in the frame of the first pose. */
function sceneOf(panel: Panel, samples: Map<string, Json>, trails: Map<number, Past[]>): Scene {
  const scene = emptyScene();
  const values = panel.sources.map((source) => valueAt(samples.get(documentOf(source)), source.path));
  const first = values.find((value) => shapeOf(value) === 'pose');
  const frame = poseOf(first) ?? { x: 0, y: 0, theta: 0 };
  values.forEach((value, index) => {
    const shape = shapeOf(value);
    if (shape === 'grid') {
      const grid = gridOf(value);
      if (grid) scene.grids.push(grid);
    }
    if (shape === 'path') scene.paths.push(pointsOf(value) ?? []);
    if (shape === 'scan') scene.scans.push({ from: frame, points: scanPoints(value, frame) });
    const pose = shape === 'pose' ? poseOf(value) : null;
    if (pose) {
      scene.poses.push(pose);
      scene.trails.push((trails.get(index) ?? []).map((past) => past.pose));
    }
  });
  return scene;
}

const atFirst: View = { x: 0, y: 0, scale: 40 };

/** The shapes of a map, from its panel's samples, and the visible part of the world: all, until somebody moves it. */
export class MapView {
  private readonly samples = new Map<string, Json>();
  private readonly trails = new Map<number, Past[]>();
  private view: View | null = null;
  private showsAll = true;

  /** `panel` may be replaced at any time. */
  constructor(public panel: Panel) {}

  /** A sample of a document. */
  take(document: string, time: number, sample: Json): void {
    this.samples.set(document, sample);
    this.panel.sources.forEach((source, index) => {
      if (documentOf(source) !== document) return;
      const pose = poseOf(valueAt(sample, source.path));
      if (!pose) return;
      const trail = this.trails.get(index) ?? [];
      const last = trail[trail.length - 1];
      if (!last || Math.hypot(pose.x - last.pose.x, pose.y - last.pose.y) > leastStep) trail.push({ time, pose });
      this.trails.set(index, trail.filter((past) => past.time >= time - this.panel.seconds));
    });
  }

  /** Other sources are shown: trails are by their numbers. */
  reset(): void {
    this.trails.clear();
    this.view = null;
    this.showsAll = true;
  }

  /** The visible part stays as it is from now on. */
  hold(): void {
    this.showsAll = false;
  }
  change(next: (before: View) => View): void {
    this.hold();
    if (this.view) this.view = next(this.view);
  }
  zoom(factor: number): void {
    this.change((before) => zoomed(before, factor, before));
  }
  /** With what is at a place of the canvas where it is. */
  zoomAt(factor: number, canvas: HTMLCanvasElement, place: Point): void {
    this.change((before) => zoomed(before, factor, fromCanvas(before, canvas.clientWidth, canvas.clientHeight, place)));
  }
  /** By pixels. */
  pan(x: number, y: number): void {
    this.change((before) => ({ ...before, x: before.x + x / before.scale, y: before.y + y / before.scale }));
  }
  showAll(canvas: HTMLCanvasElement): void {
    this.fit(this.scene(), canvas, true);
    this.showsAll = true;
  }

  /** Draws what is seen, with the first pose in the middle where it is followed; the poses that are shown. */
  draw(canvas: HTMLCanvasElement, isDark: boolean, follows: boolean): Pose[] | null {
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const context = canvas.getContext('2d');
    if (!context || width === 0) return null;
    const scene = this.scene();
    if (this.showsAll) this.fit(scene, canvas, false);
    const pose = scene.poses[0];
    if (follows && pose && this.view) this.view = { ...this.view, x: pose.x, y: pose.y };
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    drawScene(context, getComputedStyle(canvas), isDark, width, height, this.view ?? atFirst, scene);
    return scene.poses;
  }

  private scene(): Scene {
    return sceneOf(this.panel, this.samples, this.trails);
  }

  /** So that everything is seen; as it was where that is so already, unless `anyway`. */
  private fit(scene: Scene, canvas: HTMLCanvasElement, anyway: boolean): void {
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const corners = scene.grids.flatMap((grid) => [grid, { x: grid.x + grid.width * grid.resolution, y: grid.y + grid.height * grid.resolution }]);
    const points = [...scene.poses, ...scene.trails.flat(), ...scene.paths.flat(), ...scene.scans.flatMap((scan) => scan.points), ...corners];
    const shown = this.view;
    const isSeen = (point: Point) => {
      const { x, y } = toCanvas(shown!, width, height, point);
      return x >= 0 && x <= width && y >= 0 && y <= height;
    };
    if (anyway || !shown || !points.every(isSeen)) this.view = viewOf(points, width, height) ?? shown;
  }
}
