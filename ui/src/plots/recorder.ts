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

/** The numbers of sources over time, of each port at the times of its own samples. */
export class TimeRecorder {
  private readonly records = new Map<string, Record>();
  constructor(
    private readonly sources: Source[],
    public seconds: number,
  ) {}

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
    this.forget(record, time - this.seconds);
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

  /** x: seconds before the newest sample, so 0 at the most. */
  drawn(): Drawn {
    const records = [...this.records.values()].filter((record) => record.columns.size > 0);
    if (records.length === 0) return { labels: [], data: [[]] };
    const now = Math.max(...records.map((record) => record.times[record.times.length - 1] ?? 0));
    const tables = records.map((record) => [record.times.map((time) => time - now), ...record.columns.values()] as UPlot.AlignedData);
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

  private forget(record: Record, before: number): void {
    let old = 0;
    while ((record.times[old] ?? before) < before) ++old;
    if (old === 0) return;
    record.times.splice(0, old);
    for (const column of record.columns.values()) column.splice(0, old);
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
