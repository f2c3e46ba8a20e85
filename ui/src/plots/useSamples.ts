// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState, useSyncExternalStore } from 'react';
import { isMap, type Json } from '../robot/change';
import { useConnection } from '../robot/hooks';
import { documentOf, type Source } from './layout';

export interface SampleState {
  /** Why ports have no samples. */
  errors: string[];
  waiting: boolean;
  skipped: number;
  /** Seconds from one sample to the next where they are large and therefore read less often; else 0. */
  period: number;
}

const ordinaryPeriod = 0.1;

/** Calls `take` with each sample of the sources' ports that arrives, outside of rendering; nothing is asked while paused. */
export function useSamples(sources: Source[], paused: boolean, take: (document: string, time: number, sample: Json) => void): SampleState {
  const connection = useConnection();
  const newest = useRef(take);
  newest.current = take;
  const [state, setState] = useState<SampleState>({ errors: [], waiting: true, skipped: 0, period: 0 });
  const names = [...new Set(sources.map(documentOf))].sort().join('\n');

  useEffect(() => {
    if (paused || names === '') return;
    const documents = names.split('\n');
    const versions = new Map<string, number>();
    const read = () => {
      const next: SampleState = { errors: [], waiting: false, skipped: 0, period: 0 };
      for (const document of documents) {
        const shown = connection.shown(document);
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
        newest.current(document, Number(shown.value['time_s']), shown.value['value'] ?? null);
      }
      setState((before) => (JSON.stringify(before) === JSON.stringify(next) ? before : next));
    };
    const stops = documents.map((document) => connection.subscribe(document));
    const unsubscribe = connection.onChange(read);
    read();
    return () => {
      unsubscribe();
      stops.forEach((stop) => stop());
    };
  }, [connection, names, paused]);
  return state;
}

/** Calls `draw` before the next frame of the screen, once for all requests until then. */
export function useFrame(draw: () => void): () => void {
  const newest = useRef(draw);
  newest.current = draw;
  const request = useRef(0);
  useEffect(
    () => () => {
      cancelAnimationFrame(request.current);
      request.current = 0;
    },
    [],
  );
  return useRef(() => {
    if (request.current !== 0) return;
    request.current = requestAnimationFrame(() => {
      request.current = 0;
      newest.current();
    });
  }).current;
}

const dark = window.matchMedia('(prefers-color-scheme: dark)');

export function useDark(): boolean {
  return useSyncExternalStore(
    (tell) => {
      dark.addEventListener('change', tell);
      return () => dark.removeEventListener('change', tell);
    },
    () => dark.matches,
  );
}

/** Calls `draw` whenever the size of the element changes, and at first. */
export function useSize(element: { current: HTMLElement | null }, draw: () => void): void {
  useEffect(() => {
    const place = element.current;
    if (!place) return;
    const observer = new ResizeObserver(draw);
    observer.observe(place);
    return () => observer.disconnect();
  }, [element, draw]);
}
