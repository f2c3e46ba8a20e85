// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState, useSyncExternalStore } from 'react';
import { useConnection } from '../robot/hooks';
import { documentOf, type Source } from './layout';
import { follow, isSameState, noSamples, type SampleState, type Take } from './samples';

/** Calls `take` with each sample of the sources' ports that arrives, outside of rendering; nothing is asked while paused. */
export function useSamples(sources: Source[], paused: boolean, take: Take): SampleState {
  const connection = useConnection();
  const newest = useRef(take);
  newest.current = take;
  const [state, setState] = useState<SampleState>(noSamples);
  const names = [...new Set(sources.map(documentOf))].sort().join('\n');

  useEffect(() => {
    if (paused || names === '') return undefined;
    const tell = (next: SampleState) => setState((before) => (isSameState(before, next) ? before : next));
    return follow(connection, names.split('\n'), (...sample) => newest.current(...sample), tell);
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
