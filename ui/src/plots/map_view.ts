// SPDX-License-Identifier: Apache-2.0
import { drawScene, type Scene } from './draw_map';
import { fromCanvas, toCanvas, viewOf, zoomed, type Point, type Pose, type View } from './map';
import { SceneKeeper } from './scene_keeper';

const atFirst: View = { x: 0, y: 0, scale: 40 };

/** The shapes of a map, from its panel's samples, and the visible part of the world: all, until somebody moves it. */
export class MapView extends SceneKeeper {
  private view: View | null = null;
  private showsAll = true;

  override reset(): void {
    super.reset();
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
