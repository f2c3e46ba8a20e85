// SPDX-License-Identifier: Apache-2.0

/** The time (seconds since 1970) in an address such as "#past/1800000000.5"; null: it names none. */
export function timeInAddress(hash: string): number | null {
  const found = /^#past\/(\d+(?:\.\d+)?)$/.exec(hash);
  return found ? Number(found[1]) : null;
}

/** A film's time, as exactly as its length needs. */
export function timeText(seconds: number, length: number): string {
  return length < 1 ? (seconds * 1e3).toFixed(length < 0.01 ? 3 : 1) + ' ms' : seconds.toFixed(2) + ' s';
}

/** Of the slider of a film. */
export const sliderSteps = 200;

/** Times from `first` to `last` as positions of a slider, 0 to `steps`. */
export interface Scale {
  first: number;
  last: number;
  steps: number;
}

/**
 * Where the slider stands at a time. At its ends it stands only at those of the scale: a slider that stands at its end moves no
 * further, so what is just before the end could not be left towards it.
 */
export function stepOf({ first, last, steps }: Scale, time: number): number {
  if (time >= last) return steps;
  if (time <= first) return 0;
  return Math.min(steps - 1, Math.max(1, Math.round(((time - first) / (last - first)) * steps)));
}

export function timeOf({ first, last, steps }: Scale, step: number): number {
  return step >= steps ? last : first + (step / steps) * (last - first);
}
