// SPDX-License-Identifier: Apache-2.0
import { useRef } from 'react';

/** `now`, or, while a text has errors and there is none, the last one that there was. */
export function useLastGood<Content>(now: Content | null): Content | null {
  const last = useRef<Content | null>(null);
  if (now) last.current = now;
  return last.current;
}
