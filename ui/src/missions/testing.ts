// SPDX-License-Identifier: Apache-2.0
// Small missions for tests.
import type { Control } from './control';
import type { Entry, Mission } from './mission';

export function mission(control: object | null, more: Partial<Mission> = {}): Mission {
  return { run: 1, mission: 'm', who: 'ann', state: 'paused', dropped: 0, plan: null, entries: {}, control: control as Mission['control'], ...more };
}

export function control(more: Partial<Control> = {}): Control {
  return { steps: true, back: true, at: ['a'], breakpoints: [], heard: 0, ...more };
}

/** Entries of actions that began or, where an outcome is given, ended, in this order. */
export function entries(...list: [action: string, outcome?: string][]): Record<string, Entry> {
  const made = list.map(([action, outcome], index): Entry => ({ number: index + 1, time_s: index, kind: outcome === undefined ? 'began' : 'ended', action, iteration: 0, outcome }));
  return Object.fromEntries(made.map((entry) => [String(entry.number), entry]));
}
