// SPDX-License-Identifier: Apache-2.0
import { gridPixels, roundLength, toCanvas, type Grid, type Point, type Pose, type View } from './map';

/** The elements of a map, in metres. */
export interface Scene {
  grids: Grid[];
  paths: Point[][];
  scans: { from: Pose; points: Point[] }[];
  trails: Point[][];
  poses: Pose[];
}

const light = { lines: '#e3e6eb', text: '#59616f', free: [255, 255, 255], occupied: [26, 31, 41], path: '#0b6b49', scan: '#b3261e', trail: '#8fb0ee', pose: '#1f5fd0' };
const dark = { lines: '#2a303a', text: '#a0a9b8', free: [52, 59, 70], occupied: [230, 233, 238], path: '#6fd3a8', scan: '#ff9d95', trail: '#3f66ad', pose: '#82aefc' };

/** The colours of maps and of views in 3D. */
export const coloursOf = (isDark: boolean) => (isDark ? dark : light);

const pictures = new WeakMap<object, { dark: boolean; picture: HTMLCanvasElement }>();

/** A grid as a picture, made once for each sample. */
export function pictureOf(grid: Grid, isDark: boolean): HTMLCanvasElement {
  const known = pictures.get(grid);
  if (known?.dark === isDark) return known.picture;
  const picture = document.createElement('canvas');
  picture.width = grid.width;
  picture.height = grid.height;
  const colours = coloursOf(isDark);
  const pixels = gridPixels(grid, colours.free, colours.occupied) as Uint8ClampedArray<ArrayBuffer>;
  picture.getContext('2d')?.putImageData(new ImageData(pixels, grid.width, grid.height), 0, 0);
  pictures.set(grid, { dark: isDark, picture });
  return picture;
}

/** A canvas with what it shows, and how. */
interface Drawing {
  context: CanvasRenderingContext2D;
  isDark: boolean;
  width: number;
  height: number;
  view: View;
}

const at = ({ view, width, height }: Drawing, point: Point) => toCanvas(view, width, height, point);

function drawLine(drawing: Drawing, points: Point[], colour: string, thick: number): void {
  const { context } = drawing;
  context.strokeStyle = colour;
  context.lineWidth = thick;
  context.beginPath();
  for (const point of points) {
    const { x, y } = at(drawing, point);
    context.lineTo(x, y);
  }
  context.stroke();
}

function drawDot(drawing: Drawing, point: Point, side: number): void {
  const { x, y } = at(drawing, point);
  drawing.context.fillRect(x - side / 2, y - side / 2, side, side);
}

function drawGrid(drawing: Drawing, grid: Grid): void {
  const corner = at(drawing, { x: grid.x, y: grid.y + grid.height * grid.resolution });
  const side = grid.resolution * drawing.view.scale;
  drawing.context.drawImage(pictureOf(grid, drawing.isDark), corner.x, corner.y, grid.width * side, grid.height * side);
}

/** Lines at multiples of a round length. */
function drawRaster(drawing: Drawing, step: number, colour: string): void {
  const { view, width, height } = drawing;
  const low = { x: view.x - width / 2 / view.scale, y: view.y - height / 2 / view.scale };
  const high = { x: view.x + width / 2 / view.scale, y: view.y + height / 2 / view.scale };
  for (let index = Math.ceil(low.x / step); index * step <= high.x; ++index)
    drawLine(drawing, [{ x: index * step, y: low.y }, { x: index * step, y: high.y }], colour, index === 0 ? 2 : 1);
  for (let index = Math.ceil(low.y / step); index * step <= high.y; ++index)
    drawLine(drawing, [{ x: low.x, y: index * step }, { x: high.x, y: index * step }], colour, index === 0 ? 2 : 1);
}

function drawPose(drawing: Drawing, pose: Pose, colour: string): void {
  const { context } = drawing;
  const { x, y } = at(drawing, pose);
  context.save();
  context.translate(x, y);
  context.rotate(-pose.theta);
  context.fillStyle = colour;
  context.beginPath();
  context.moveTo(13, 0);
  context.lineTo(-8, -7);
  context.lineTo(-4, 0);
  context.lineTo(-8, 7);
  context.fill();
  context.restore();
}

/** How long that length is. */
function drawScale({ context, height, view }: Drawing, step: number, colour: string, font: string): void {
  context.fillStyle = colour;
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(10, height - 15);
  context.lineTo(10, height - 10);
  context.lineTo(10 + step * view.scale, height - 10);
  context.lineTo(10 + step * view.scale, height - 15);
  context.stroke();
  context.font = font;
  context.fillText(Number(step.toPrecision(3)) + ' m', 16, height - 16);
}

export function drawScene(context: CanvasRenderingContext2D, style: CSSStyleDeclaration, isDark: boolean, width: number, height: number, view: View, scene: Scene): void {
  const colours = coloursOf(isDark);
  const drawing = { context, isDark, width, height, view };
  const step = roundLength(view, 60);
  context.clearRect(0, 0, width, height);
  context.lineJoin = 'round';
  context.imageSmoothingEnabled = false;
  for (const grid of scene.grids) drawGrid(drawing, grid);
  drawRaster(drawing, step, colours.lines);
  for (const trail of scene.trails) drawLine(drawing, trail, colours.trail, 2.5);
  for (const path of scene.paths) {
    drawLine(drawing, path, colours.path, 2);
    context.fillStyle = colours.path;
    for (const end of path.slice(-1)) drawDot(drawing, end, 8);
  }
  context.fillStyle = colours.scan;
  for (const point of scene.scans.flatMap((scan) => scan.points)) drawDot(drawing, point, 4);
  for (const pose of scene.poses) drawPose(drawing, pose, colours.pose);
  drawScale(drawing, step, colours.text, '11px ' + style.fontFamily);
}
