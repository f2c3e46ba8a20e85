// SPDX-License-Identifier: Apache-2.0
import type { Json } from '../robot/change';
import type { Scene } from './draw_map';
import { pointsOf, shapeOf, valueAt } from './fields';
import { documentOf, type Panel } from './layout';
import { gridOf, poseOf, scanPoints, type Pose } from './map';

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

/** The newest samples of a panel, and the trails of its poses, as shapes in the plane: for maps and views in 3D. */
export class SceneKeeper {
  private readonly samples = new Map<string, Json>();
  private readonly trails = new Map<number, Past[]>();

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
  }

  scene(): Scene {
    return sceneOf(this.panel, this.samples, this.trails);
  }
}
