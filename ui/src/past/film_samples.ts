// SPDX-License-Identifier: Apache-2.0
import type { Drawn } from '../plots/recorder';
import type { Film } from './film';

/**
 * One moment by two clocks: that of the robot's journal (seconds since 1970) and that of samples (seconds of the studio's
 * monotonic clock), and how many seconds apart they may have been read.
 */
export interface Clock {
  now_s: number;
  studio_s: number;
  within_s: number;
}

export function isClock(answer: unknown): answer is Clock {
  const clock = answer as Partial<Record<keyof Clock, unknown>> | null;
  return typeof clock?.now_s === 'number' && typeof clock.studio_s === 'number' && typeof clock.within_s === 'number';
}

/** The begin of a film by the clock of samples. */
export function beginOf({ transition, length }: Film, clock: Clock): number {
  return transition.ended_s - (transition.lasted_s ?? length) - clock.now_s + clock.studio_s;
}

/** The time of the film that charts show: what was before and what came of it belong to it, a second at least. */
export function windowOf({ length }: Film): [from: number, to: number] {
  const margin = Math.max(1, length / 4);
  return [-margin, length + margin];
}

/** The values of lines at a time: those of the last samples until then; null where there was none, or the line was interrupted. */
export function valuesAt({ labels, data }: Drawn, at: number): (number | null)[] {
  const after = data[0].findIndex((time) => time > at);
  return labels.map((_, index) => {
    const line = data[index + 1] ?? [];
    for (let place = (after < 0 ? data[0].length : after) - 1; place >= 0; --place) if (line[place] !== undefined) return line[place] ?? null;
    return null;
  });
}

/** The range times a factor, around a time in it, within the whole. Null: it is the whole. */
export function zoomedTo(range: [number, number], factor: number, around: number, whole: [number, number]): [number, number] | null {
  const middle = Math.min(range[1], Math.max(range[0], around));
  const zoomed: [number, number] = [Math.max(whole[0], middle + (range[0] - middle) * factor), Math.min(whole[1], middle + (range[1] - middle) * factor)];
  return zoomed[0] <= whole[0] && zoomed[1] >= whole[1] ? null : zoomed;
}
