// SPDX-License-Identifier: Apache-2.0

/** How the outcome of a request is shown. One that this page does not know has not brought about what was requested. */
export function toneOfOutcome(outcome: string): 'good' | 'idle' | 'bad' {
  if (outcome === 'done') return 'good';
  return outcome === 'superseded' ? 'idle' : 'bad';
}
