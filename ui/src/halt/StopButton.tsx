// SPDX-License-Identifier: Apache-2.0
import { useState } from 'react';
import { useConnection } from '../robot/hooks';
import type { Status } from '../robot/types';
import { haltText } from './halt';

/** Brings the robot to rest, whoever commands it, and shows that it is held until somebody releases it. */
export function StopButton({ status }: { status: Status }) {
  const connection = useConnection();
  const [problem, setProblem] = useState<string | null>(null);
  if (!connection.mayOperate) return null;

  const ask = (verb: 'stop' | 'release', failure: string) => {
    setProblem(null);
    connection.call(verb, {}).catch((error: Error) => setProblem(failure + ': ' + error.message));
  };

  return (
    <div className="stop">
      {status.stopped_by != null && (
        <button type="button" onClick={() => ask('release', 'Not released')}>Release</button>
      )}
      <button type="button" className="stop-button" title="Brings the robot to rest at once, whoever commands it" onClick={() => ask('stop', 'Not stopped')}>
        Stop the robot
      </button>
      {problem && <span className="bad" role="alert">{problem}</span>}
    </div>
  );
}

/** Says that the robot was halted, why, and whether it is at rest. */
export function HaltBanner({ status }: { status: Status }) {
  const text = haltText(status);
  return text === '' ? null : <p className="banner halted" role="alert">{text}</p>;
}
