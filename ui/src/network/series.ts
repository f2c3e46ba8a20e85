// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json } from '../robot/change';

/** The numbers in a sample by their paths: {pose: {x: 1}} has "pose.x"; the first `most` of them. */
export function numbersIn(value: Json, most = 6): [path: string, number: number][] {
  const found: [string, number][] = [];
  const visit = (part: Json, path: string) => {
    if (found.length >= most) return;
    if (typeof part === 'number') found.push([path, part]);
    else if (typeof part === 'boolean') found.push([path, part ? 1 : 0]);
    else if (Array.isArray(part)) part.forEach((item, index) => visit(item, path + '[' + index + ']'));
    else if (isMap(part)) for (const [key, entry] of Object.entries(part)) visit(entry, path === '' ? key : path + '.' + key);
  };
  visit(value, '');
  return found.map(([path, number]) => [path === '' ? 'value' : path, number]);
}

/** Samples of the last seconds as columns: times, then one for each path; null where a sample lacks it. */
export class Series {
  readonly times: number[] = [];
  readonly columns = new Map<string, (number | null)[]>();
  constructor(
    private readonly seconds: number,
    private readonly mostPaths = 6,
  ) {}

  /** False where the sample is not newer than the last one. */
  add(time: number, value: Json): boolean {
    const last = this.times[this.times.length - 1];
    if (last !== undefined && time <= last) return false;
    for (const [path] of numbersIn(value, this.mostPaths)) {
      if (!this.columns.has(path) && this.columns.size < this.mostPaths)
        this.columns.set(path, new Array<number | null>(this.times.length).fill(null));
    }
    const numbers = new Map(numbersIn(value, this.mostPaths));
    this.times.push(time);
    for (const [path, column] of this.columns) column.push(numbers.get(path) ?? null);
    let old = 0;
    while ((this.times[old] ?? time) < time - this.seconds) ++old;
    if (old > 0) {
      this.times.splice(0, old);
      for (const column of this.columns.values()) column.splice(0, old);
    }
    return true;
  }
}
