// SPDX-License-Identifier: Apache-2.0
import { useRef, type RefObject } from 'react';

/** The value as it was when the component was last drawn, for functions that stay the same while it changes. */
export function useLatest<Value>(value: Value): RefObject<Value> {
  const latest = useRef(value);
  latest.current = value;
  return latest;
}
