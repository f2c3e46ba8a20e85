// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json } from '../robot/change';
import type { Connection, Shown } from '../robot/connection';

export interface SampleState {
  /** Why ports have no samples. */
  errors: string[];
  waiting: boolean;
  skipped: number;
  /** Seconds from one sample to the next where they are large and therefore read less often; else 0. */
  period: number;
}

export const noSamples: SampleState = { errors: [], waiting: true, skipped: 0, period: 0 };

/** The documents of ports, and who is told of their samples. */
export type Samples = Pick<Connection, 'onChange' | 'shown' | 'subscribe'>;

/** `time`: seconds of the studio's monotonic clock at which the sample was read. */
export type Take = (document: string, time: number, sample: Json) => void;

const ordinaryPeriod = 0.1;

/** Calls `take` with each sample of these documents that arrives, and `tell` with how they are, until the function that is returned is called. */
export function follow(samples: Samples, documents: string[], take: Take, tell: (state: SampleState) => void): () => void {
  const versions = new Map<string, number>();
  let before: (Shown | undefined)[] | null = null;
  const read = () => {
    const now = documents.map((document) => samples.shown(document));
    if (before?.every((one, index) => one === now[index])) return; // another document has changed
    before = now;
    const next: SampleState = { ...noSamples, errors: [], waiting: false };
    for (const [index, document] of documents.entries()) {
      const shown = now[index];
      next.skipped += shown?.skipped ?? 0;
      if (shown?.error) next.errors.push(document.slice('port/'.length).replace('/', '.') + ': ' + shown.error);
      if (!shown || !isMap(shown.value)) {
        next.waiting ||= !shown?.error;
        continue;
      }
      const period = Number(shown.value['period_s'] ?? 0);
      if (period >= ordinaryPeriod) next.period = Math.max(next.period, period);
      if (shown.error || versions.get(document) === shown.version) continue;
      versions.set(document, shown.version);
      take(document, Number(shown.value['time_s']), shown.value['value'] ?? null);
    }
    tell(next);
  };
  const stops = documents.map((document) => samples.subscribe(document));
  const unsubscribe = samples.onChange(read);
  read();
  return () => {
    unsubscribe();
    stops.forEach((stop) => stop());
  };
}

export const isSameState = (one: SampleState, other: SampleState) => JSON.stringify(one) === JSON.stringify(other);
