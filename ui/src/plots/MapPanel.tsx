// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState } from 'react';
import type { Json } from '../robot/change';
import { pointsOf, shapeOf, valueAt } from './fields';
import { Footer } from './Footer';
import { documentOf, sourceText, type Panel } from './layout';
import { drawScene, type Scene } from './draw_map';
import { fromCanvas, gridOf, poseOf, scanPoints, toCanvas, viewOf, zoomed, type Point, type Pose, type View } from './map';
import { useDark, useFrame, useSamples, useSize } from './useSamples';

interface Past {
  time: number;
  pose: Pose;
}

/** A pose that moved less than this is not a new point of its trail. */
const leastStep = 0.005;

function emptyScene(): Scene {
  return { grids: [], paths: [], scans: [], trails: [], poses: [] };
}

/** The scene of the sources' newest samples, with scans in the frame of the first pose. */
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

function poseText(pose: Pose): string {
  return 'x ' + pose.x.toFixed(2) + ' m, y ' + pose.y.toFixed(2) + ' m, ' + ((pose.theta * 180) / Math.PI).toFixed(0) + '°';
}

export function MapPanel({ panel, paused }: { panel: Panel; paused: boolean }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const words = useRef<HTMLParagraphElement>(null);
  const samples = useRef(new Map<string, Json>());
  const trails = useRef(new Map<number, Past[]>());
  const view = useRef<View | null>(null);
  /** Nobody has moved the map: it shows everything. */
  const showsAll = useRef(true);
  const drag = useRef<Point | null>(null);
  const [follow, setFollow] = useState(false);
  const dark = useDark();

  const size = () => ({ width: canvas.current?.clientWidth ?? 0, height: canvas.current?.clientHeight ?? 0 });
  /** Moves the view so that everything is seen; leaves it where that is so already, unless `anyway`. */
  const fitAll = (scene: Scene, anyway: boolean) => {
    const corners = scene.grids.flatMap((grid) => [grid, { x: grid.x + grid.width * grid.resolution, y: grid.y + grid.height * grid.resolution }]);
    const points = [...scene.poses, ...scene.trails.flat(), ...scene.paths.flat(), ...scene.scans.flatMap((scan) => scan.points), ...corners];
    const { width, height } = size();
    const shown = view.current;
    const isSeen = (point: Point) => {
      const { x, y } = toCanvas(shown!, width, height, point);
      return x >= 0 && x <= width && y >= 0 && y <= height;
    };
    if (anyway || !shown || !points.every(isSeen)) view.current = viewOf(points, width, height) ?? shown;
  };
  const draw = useFrame(() => {
    const { width, height } = size();
    const context = canvas.current?.getContext('2d');
    if (!canvas.current || !context || width === 0) return;
    const scene = sceneOf(panel, samples.current, trails.current);
    if (showsAll.current) fitAll(scene, false);
    const pose = scene.poses[0];
    if (follow && pose && view.current) view.current = { ...view.current, x: pose.x, y: pose.y };
    const ratio = window.devicePixelRatio || 1;
    canvas.current.width = Math.round(width * ratio);
    canvas.current.height = Math.round(height * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    drawScene(context, getComputedStyle(canvas.current), dark, width, height, view.current ?? { x: 0, y: 0, scale: 40 }, scene);
    if (words.current) words.current.textContent = scene.poses.map(poseText).join('; ');
  });
  const state = useSamples(panel.sources, paused, (document, time, sample) => {
    samples.current.set(document, sample);
    panel.sources.forEach((source, index) => {
      if (documentOf(source) !== document) return;
      const pose = poseOf(valueAt(sample, source.path));
      if (!pose) return;
      const trail = trails.current.get(index) ?? [];
      const last = trail[trail.length - 1];
      if (!last || Math.hypot(pose.x - last.pose.x, pose.y - last.pose.y) > leastStep) trail.push({ time, pose });
      trails.current.set(index, trail.filter((past) => past.time >= time - panel.seconds));
    });
    draw();
  });

  const sources = JSON.stringify(panel.sources);
  useEffect(() => {
    trails.current.clear(); // they are by the numbers of sources
    view.current = null;
    showsAll.current = true;
    draw();
  }, [sources, draw]);
  useEffect(draw, [draw, dark, follow]);
  useSize(canvas, draw);

  const change = (next: (before: View) => View) => {
    showsAll.current = false;
    if (view.current) view.current = next(view.current);
    draw();
  };
  const zoom = (factor: number) => change((before) => zoomed(before, factor, before));
  // React's own listener for wheels is passive, so that it could not keep the page from scrolling.
  useEffect(() => {
    const place = canvas.current;
    const turn = (event: WheelEvent) => {
      event.preventDefault();
      change((before) => {
        const at = fromCanvas(before, size().width, size().height, { x: event.offsetX, y: event.offsetY });
        return zoomed(before, Math.exp(-event.deltaY * 0.0015), at);
      });
    };
    place?.addEventListener('wheel', turn, { passive: false });
    return () => place?.removeEventListener('wheel', turn);
  }, []);
  const fitNow = () => {
    fitAll(sceneOf(panel, samples.current, trails.current), true);
    showsAll.current = true;
    setFollow(false);
    draw();
  };
  const pan = (x: number, y: number) => {
    setFollow(false);
    change((before) => ({ ...before, x: before.x + x / before.scale, y: before.y + y / before.scale }));
  };

  return (
    <>
      <div className="panel-tools">
        <button type="button" className="small" aria-label="Zoom in" onClick={() => zoom(1.5)}>+</button>
        <button type="button" className="small" aria-label="Zoom out" onClick={() => zoom(1 / 1.5)}>−</button>
        <button type="button" className="small" onClick={fitNow}>All</button>
        <label><input type="checkbox" checked={follow} onChange={(event) => {
          showsAll.current = false;
          setFollow(event.target.checked);
        }} /> follow</label>
        <p className="quiet" ref={words} />
      </div>
      <canvas
        ref={canvas}
        className="map"
        role="img"
        tabIndex={0}
        aria-label={'Map of ' + panel.sources.map(sourceText).join(', ') + '; arrow keys move it, plus and minus zoom'}
        onPointerDown={(event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          drag.current = { x: event.clientX, y: event.clientY };
        }}
        onPointerMove={(event) => {
          if (!drag.current) return;
          pan(drag.current.x - event.clientX, event.clientY - drag.current.y);
          drag.current = { x: event.clientX, y: event.clientY };
        }}
        onPointerUp={() => (drag.current = null)}
        onPointerCancel={() => (drag.current = null)}
        onKeyDown={(event) => {
          if (event.key === 'ArrowLeft') pan(-40, 0);
          else if (event.key === 'ArrowRight') pan(40, 0);
          else if (event.key === 'ArrowUp') pan(0, 40);
          else if (event.key === 'ArrowDown') pan(0, -40);
          else if (event.key === '+') zoom(1.5);
          else if (event.key === '-') zoom(1 / 1.5);
          else return;
          event.preventDefault();
        }}
      />
      <Footer state={state} paused={paused} />
    </>
  );
}
