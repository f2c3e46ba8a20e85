// SPDX-License-Identifier: Apache-2.0
import UPlot from 'uplot';
import type { Json } from '../robot/change';
import { valueAt } from './fields';
import { documentOf, sourceText, type Source } from './layout';

/** The data of a chart: names of lines, then x and the lines' values; null: nothing there. */
export interface Drawn {
  labels: string[];
  data: UPlot.AlignedData;
}

/** The limit of the lines that one list over time makes. */
export const mostLinesOfList = 32;

interface Record {
  times: number[];
  /** The values at `times`, by source and element. */
  columns: Map<string, (number | null)[]>;
}

function numberOf(value: Json | undefined): number | null {
  return typeof value === 'number' ? value : typeof value === 'boolean' ? Number(value) : null;
}

/** How long samples are kept, in seconds: as long as the longest window of a panel. */
export const keptSeconds = 600;

/** The samples of a record from one time to another; x: seconds after `zero`. */
function part({ times, columns }: Record, from: number, to: number, zero: number): UPlot.AlignedData {
  const [first, end] = [firstFrom(times, from), firstFrom(times, to)];
  const last = times[end] === to ? end + 1 : end;
  return [times.slice(first, last).map((time) => time - zero), ...[...columns.values()].map((column) => column.slice(first, last))];
}

/** The index of the first of rising times that is not before `time`. */
function firstFrom(times: number[], time: number): number {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! < time) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The numbers of sources over time, of each port at the times of its own samples (seconds of the studio's monotonic clock). */
export class TimeRecorder {
  private readonly records = new Map<string, Record>();
  constructor(private readonly sources: Source[]) {}

  /** How many numbers are kept, times included. */
  get size(): number {
    return [...this.records.values()].reduce((sum, record) => sum + record.times.length * (1 + record.columns.size), 0);
  }

  add(document: string, time: number, sample: Json): void {
    const record = this.recordOf(document);
    const last = record.times[record.times.length - 1];
    if (last !== undefined && time <= last) return;
    const numbers = this.numbersOf(document, sample);
    for (const label of numbers.keys()) {
      if (!record.columns.has(label)) record.columns.set(label, new Array<number | null>(record.times.length).fill(null));
    }
    record.times.push(time);
    for (const [label, column] of record.columns) column.push(numbers.get(label) ?? null);
    this.forget(record, firstFrom(record.times, time - keptSeconds));
  }

  /** Forgets the older half of each port's samples. */
  halve(): void {
    for (const record of this.records.values()) this.forget(record, Math.ceil(record.times.length / 2));
  }

  /** Interrupts the lines: values that come from now on are not joined by lines to those before. */
  gap(): void {
    for (const record of this.records.values()) {
      const last = record.times[record.times.length - 1];
      if (last === undefined) continue;
      record.times.push(last + 1e-6);
      for (const column of record.columns.values()) column.push(null);
    }
  }

  /** The last seconds; x: seconds before the newest sample, so 0 at the most. */
  drawn(seconds: number): Drawn {
    const now = Math.max(...[...this.records.values()].map((record) => record.times[record.times.length - 1] ?? -Infinity));
    return this.between(now - seconds, now, now);
  }

  /** The samples from one time to another; x: seconds after `zero`. No lines where there are no samples of that time. */
  between(from: number, to: number, zero: number): Drawn {
    const records = [...this.records.values()].filter((record) => record.columns.size > 0);
    const tables = records.map((record) => part(record, from, to, zero));
    if (tables.every((table) => table[0].length === 0)) return { labels: [], data: [[]] };
    return { labels: records.flatMap((record) => [...record.columns.keys()]), data: tables.length === 1 ? tables[0]! : UPlot.join(tables) };
  }

  private recordOf(document: string): Record {
    let record = this.records.get(document);
    if (!record) this.records.set(document, (record = { times: [], columns: new Map() }));
    return record;
  }

  private numbersOf(document: string, sample: Json): Map<string, number | null> {
    const numbers = new Map<string, number | null>();
    for (const source of this.sources) {
      if (documentOf(source) !== document) continue;
      const value = valueAt(sample, source.path);
      if (!Array.isArray(value)) numbers.set(sourceText(source), numberOf(value));
      else value.slice(0, mostLinesOfList).forEach((item, index) => numbers.set(sourceText(source) + '[' + index + ']', numberOf(item)));
    }
    return numbers;
  }

  private forget(record: Record, count: number): void {
    if (count === 0) return;
    record.times.splice(0, count);
    for (const column of record.columns.values()) column.splice(0, count);
  }
}

/** The newest lists of sources, over their indices. */
export class ProfileRecorder {
  private readonly lists = new Map<string, (number | null)[]>();
  constructor(private readonly sources: Source[]) {}

  add(document: string, _time: number, sample: Json): void {
    for (const source of this.sources) {
      if (documentOf(source) !== document) continue;
      const value = valueAt(sample, source.path);
      this.lists.set(sourceText(source), Array.isArray(value) ? value.map(numberOf) : []);
    }
  }

  gap(): void {}

  drawn(): Drawn {
    const lists = [...this.lists.values()];
    const longest = lists.reduce((most, list) => Math.max(most, list.length), 0);
    const indices = Array.from({ length: longest }, (_, index) => index);
    const padded = lists.map((list) => (list.length === longest ? list : indices.map((index) => list[index] ?? null)));
    return { labels: [...this.lists.keys()], data: [indices, ...padded] };
  }
}
