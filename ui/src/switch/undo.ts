// SPDX-License-Identifier: Apache-2.0
import type { Action, RobotEvent } from '../robot/types';
import { subjectOf } from './difference';

const inverses: Record<string, string> = {
  connect: 'disconnect', disconnect: 'connect', configure: 'cleanup', cleanup: 'configure', start: 'stop', stop: 'start', deploy: 'undeploy', undeploy: 'deploy',
};

/** An action that undoes others, as it was reported. */
export interface UndoStep {
  number: number;
  subject: string;
  done: boolean;
}

export interface Undoing {
  /** Why, and to what the robot goes back; null: nothing is undone. */
  why: string | null;
  steps: UndoStep[];
}

/** The undoing of a transition by the events after the request, until the robot says how that ended. */
export function undoingOf(events: RobotEvent[], after: number): Undoing {
  const undoing: Undoing = { why: null, steps: [] };
  for (const event of events) {
    if (event.number <= after) continue;
    if (event.kind === 'transition_failed' || event.kind === 'transition_done') break;
    if (event.kind === 'transition_undone') undoing.why = event.message;
    if (undoing.why === null) continue;
    if (event.kind === 'action_done' || event.kind === 'action_failed') {
      undoing.steps.push({ number: event.number, subject: event.subject, done: event.kind === 'action_done' });
    }
  }
  return undoing;
}

/** The actions whose opposite was done. */
export function undoneOf(actions: Action[], undoing: Undoing): Set<number> {
  const done = undoing.steps.filter((step) => step.done).map((step) => step.subject);
  const undone = new Set<number>();
  for (const action of actions) {
    const kind = inverses[action.kind];
    if (!kind) continue;
    const subject = subjectOf({ ...action, kind });
    if (done.some((said) => said === subject || said.startsWith(subject + ' '))) undone.add(action.id);
  }
  return undone;
}
