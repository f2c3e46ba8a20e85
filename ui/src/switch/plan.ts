// SPDX-License-Identifier: Apache-2.0
import type { PlannedTransition } from '../robot/types';

/** "stop 1, start 2": how many actions there are of each kind. */
export function countsText(counts: { [kind: string]: number } | undefined): string {
  return Object.entries(counts ?? {})
    .filter(([kind, count]) => count > 0 && kind !== 'total' && kind !== 'state_changes')
    .map(([kind, count]) => kind + ' ' + count)
    .join(', ');
}

/** How far the estimate can be trusted; '': all actions have been measured. */
export function unmeasuredText(unmeasured: number, all: number): string {
  if (unmeasured === 0) return '';
  if (unmeasured === all) return 'None of these actions has been measured yet; this is a guess.';
  return unmeasured + ' of ' + all + ' actions have not been measured yet and are estimated from others of their kind.';
}

/** The seconds that each action typically takes, by its number. */
export function typicalOf({ actions, estimate_s }: Pick<PlannedTransition, 'actions' | 'estimate_s'>): Map<number, number> {
  const typical = new Map<number, number>();
  actions.forEach((action, index) => {
    const seconds = estimate_s?.actions?.[index];
    if (seconds !== undefined) typical.set(action.id, seconds);
  });
  return typical;
}
