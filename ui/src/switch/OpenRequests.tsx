// SPDX-License-Identifier: Apache-2.0
import { useState } from 'react';
import { ActionButton } from '../ActionButton';
import { useConnection } from '../robot/hooks';
import type { OpenRequest, Status } from '../robot/types';
import type { Undoing } from './undo';

const states: Record<string, string> = {
  waiting: 'waits', planning: 'is planned', prepare: 'is prepared', commit: 'is committed', retire: 'is past its point of commit', undo: 'is undone',
};

/** The requests in progress, whoever asked for them, and how to cancel each. */
export function OpenRequests({ status }: { status: Status }) {
  const connection = useConnection();
  const [problem, setProblem] = useState<string | null>(null);
  const fixed = !connection.mayOperate;

  const cancel = (request: OpenRequest) => {
    setProblem(null);
    connection.call('cancel', { request: request.request }).catch((error: Error) => setProblem('Not cancelled: ' + error.message));
  };

  return (
    <div className="open-requests">
      {status.requests.map((request) => {
        const completes = request.state === 'retire' || request.state === 'undo';
        return (
          <div key={request.request} className="open-request">
            <span>
              <strong>{request.to || 'the empty network'}</strong> {states[request.state] ?? request.state}
              {request.cancelled_by !== null && <>, cancelled by {request.cancelled_by}</>}
              {request.who !== '' && <span className="quiet"> (asked for by {request.who})</span>}
            </span>
            {!fixed && (
              <ActionButton
                type="button"
                whyNot={completes ? 'it ends by itself now' : request.cancelled_by !== null ? 'it is cancelled already' : ''}
                title="Undo it: the robot runs again what it ran before"
                onClick={() => cancel(request)}
              >
                Cancel<span className="hidden"> {request.to}</span>
              </ActionButton>
            )}
          </div>
        );
      })}
      {problem && <p className="bad" role="alert">{problem}</p>}
    </div>
  );
}

/** The actions that undo a transition, as the robot reports them. */
export function UndoList({ undoing }: { undoing: Undoing }) {
  if (undoing.why === null) return null;
  return (
    <section aria-label="Undo">
      <h3>
        undo <span className="quiet">{undoing.steps.length} actions</span>
      </h3>
      <p className="quiet">{undoing.why}</p>
      <ul className="actions">
        {undoing.steps.map((step) => (
          <li key={step.number} className={step.done ? 'done' : 'failed'} data-undo={step.done ? 'done' : 'failed'}>
            <span aria-hidden="true">{step.done ? '✓' : '✗'}</span> {step.subject}
            <span className="hidden">, {step.done ? 'done' : 'failed'}</span>
          </li>
        ))}
      </ul>
    </section>
  );
}
