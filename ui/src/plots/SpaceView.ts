// SPDX-License-Identifier: Apache-2.0
import { PerspectiveCamera, Scene as World, WebGLRenderer } from 'three';
import type { Pose } from './map';
import { cameraOf, fieldOfView, fitted, orbitAtFirst, type Orbit } from './orbit';
import { SceneKeeper } from './scene_keeper';
import { dispose, spaceOf } from './space_scene';

/** A panel's samples in 3D, and the camera that looks at them: at all, until somebody moves it. */
export class SpaceView extends SceneKeeper {
  private readonly camera = new PerspectiveCamera(fieldOfView, 1, 0.05, 20000);
  private renderer: WebGLRenderer | null = null;
  private orbit: Orbit = orbitAtFirst;
  private fits = true;

  /** Throws where the browser has no WebGL. */
  open(canvas: HTMLCanvasElement): void {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.camera.up.set(0, 0, 1);
  }
  close(): void {
    this.renderer?.dispose();
    this.renderer = null;
  }

  override reset(): void {
    super.reset();
    this.fits = true;
  }
  /** The camera stays as it is from now on, but for what `next` does. */
  change(next: (before: Orbit) => Orbit): void {
    this.fits = false;
    this.orbit = next(this.orbit);
  }
  /** All is seen from now on, as long as nobody moves the camera. */
  fit(): void {
    this.fits = true;
  }

  /** Draws what is seen, with the first pose in the middle where it is followed; the poses that are shown. */
  draw(canvas: HTMLCanvasElement, isDark: boolean, follows: boolean): Pose[] | null {
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!this.renderer || width === 0 || height === 0) return null;
    const scene = this.scene();
    const aspect = width / height;
    if (this.fits) {
      const corners = scene.grids.flatMap((grid) => [grid, { x: grid.x + grid.width * grid.resolution, y: grid.y + grid.height * grid.resolution }]);
      this.orbit = fitted(this.orbit, [...scene.poses, ...scene.trails.flat(), ...scene.paths.flat(), ...scene.scans.flatMap((scan) => scan.points), ...corners], aspect);
    }
    const [pose] = scene.poses;
    if (follows && pose) this.orbit = { ...this.orbit, target: { x: pose.x, y: pose.y, z: 0 } };
    const { x, y, z } = cameraOf(this.orbit);
    const { target, distance } = this.orbit;
    this.camera.aspect = aspect;
    this.camera.position.set(x, y, z);
    this.camera.lookAt(target.x, target.y, target.z);
    this.camera.updateProjectionMatrix();
    this.renderer.setPixelRatio(window.devicePixelRatio || 1);
    this.renderer.setSize(width, height, false);
    const world = new World();
    const space = spaceOf(scene, isDark, target, distance);
    world.add(space);
    this.renderer.render(world, this.camera);
    dispose(space);
    return scene.poses;
  }
}
