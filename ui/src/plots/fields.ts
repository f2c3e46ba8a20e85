// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json, type JsonMap } from '../robot/change';

/** Keys of maps and indices of lists, from the whole sample inward. */
export type Path = string[];

/** The forms in which a value can be shown. */
export type Shape = 'number' | 'numbers' | 'pose' | 'path' | 'scan' | 'grid' | 'image';
export type PanelKind = 'time' | 'profile' | 'image' | 'map' | 'space';

export interface Field {
  path: Path;
  shape: Shape;
  /** How many numbers a list has. */
  size: number;
}

export const kindNames: Record<PanelKind, string> = { time: 'plot over time', profile: 'profile of a list', image: 'image', map: 'map', space: '3D view' };
const shapesOf: Record<PanelKind, Shape[]> = {
  time: ['number', 'numbers'],
  profile: ['numbers'],
  image: ['image'],
  map: ['pose', 'path', 'scan', 'grid'],
  space: ['pose', 'path', 'scan', 'grid'],
};
/** Longer lists are shown as profiles rather than as one line for each element, where nobody says otherwise. */
const mostLinesUnasked = 12;
const longestListed = 16;

export function fits(kind: PanelKind, shape: Shape): boolean {
  return shapesOf[kind].includes(shape);
}

export function suggestedKind(field: Field): PanelKind {
  if (field.shape === 'image') return 'image';
  if (field.shape === 'number' || (field.shape === 'numbers' && field.size <= mostLinesUnasked)) return 'time';
  return field.shape === 'numbers' ? 'profile' : 'map';
}

export function hasOwn(map: object, key: string): boolean {
  return Object.prototype.hasOwnProperty.call(map, key);
}

/** undefined: there is no such part. */
export function valueAt(value: Json | undefined, path: Path): Json | undefined {
  let part = value;
  for (const key of path) {
    if (Array.isArray(part)) part = part[Number(key)];
    else if (isMap(part) && hasOwn(part, key)) part = part[key];
    else return undefined;
  }
  return part;
}

/** ["pose", "ranges", "3"] -> "pose.ranges[3]". */
export function pathText(path: Path): string {
  return path.reduce((text, key) => (/^\d+$/.test(key) ? text + '[' + key + ']' : text === '' ? key : text + '.' + key), '');
}

export function isNumber(value: Json | undefined): value is number {
  return typeof value === 'number';
}

/** Infinities and what is not a number arrive as null. */
function isListOfNumbers(value: Json | undefined): value is (number | null)[] {
  return Array.isArray(value) && value.length > 0 && value.every((item) => item === null || typeof item === 'number');
}

function isPoint(value: Json | undefined): boolean {
  return isMap(value) && isNumber(value['x']) && isNumber(value['y']);
}

/** The list of points or poses of a path; null: it is none. */
export function pointsOf(value: Json | undefined): { x: number; y: number }[] | null {
  const list = isMap(value) ? (value['poses'] ?? value['points']) : value;
  if (!Array.isArray(list) || !list.every(isPoint)) return null;
  if (!isMap(value) && list.length === 0) return null;
  return list as unknown as { x: number; y: number }[];
}

function shapeOfMap(value: JsonMap): Shape | null {
  const has = (...keys: string[]) => keys.every((key) => isNumber(value[key]));
  if (has('width', 'height') && Array.isArray(value['rgb'])) return 'image';
  if (has('resolution', 'width', 'height', 'x', 'y') && Array.isArray(value['cells'])) return 'grid';
  if (has('first_angle') && (has('angle_step') || has('step')) && Array.isArray(value['ranges'])) return 'scan';
  if (pointsOf(value)) return 'path';
  return has('x', 'y') ? 'pose' : null;
}

export function shapeOf(value: Json | undefined): Shape | null {
  if (typeof value === 'number' || typeof value === 'boolean') return 'number';
  if (isMap(value)) return shapeOfMap(value);
  if (!Array.isArray(value)) return null;
  return isListOfNumbers(value) ? 'numbers' : pointsOf(value) ? 'path' : null;
}

/** The parts of a sample that can be shown, the outer before the inner; the first `most`. */
export function fieldsOf(value: Json, most = 100): Field[] {
  const found: Field[] = [];
  const visit = (part: Json, path: Path) => {
    if (found.length >= most) return;
    const shape = shapeOf(part);
    if (shape) found.push({ path, shape, size: Array.isArray(part) ? part.length : 1 });
    if (shape === 'image') return;
    if (Array.isArray(part)) {
      if (shape === 'path' || part.length > longestListed) return;
      part.forEach((item, index) => visit(item, [...path, String(index)]));
    } else if (isMap(part)) {
      for (const [key, entry] of Object.entries(part)) visit(entry, [...path, key]);
    }
  };
  visit(value, []);
  return found;
}
