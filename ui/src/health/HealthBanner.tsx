// SPDX-License-Identifier: Apache-2.0
import { useState } from 'react';
import { ActionButton } from '../ActionButton';
import { reason } from '../reason';
import { useConnection } from '../robot/hooks';
import { toneOfOutcome } from '../robot/outcome';
import type { Status } from '../robot/types';
import { howLong, troublesOf } from './health';

/** Requests what runs once more. */
function useRepair() {
  const connection = useConnection();
  const [busy, setBusy] = useState(false);
  const [problem, setProblem] = useState<string | null>(null);
  const repair = async () => {
    setBusy(true);
    setProblem(null);
    try {
      const answer = await connection.call('repair', {});
      const result = answer as unknown as { outcome: string; error?: string };
      if (toneOfOutcome(result.outcome) !== 'good') setProblem(result.error ?? result.outcome);
    } catch (error) {
      setProblem(reason(error));
    } finally {
      setBusy(false);
    }
  };
  return { may: connection.mayOperate, busy, problem, repair };
}

/**
 * The missing or faulty parts of a robot, each with its time, its reason and its repair; nothing of a robot that has
 * all that it needs.
 */
export function HealthBanner({ status }: { status: Status }) {
  const { may, busy, problem, repair } = useRepair();
  if (status.lost != null) {
    return (
      <p className="banner halted" role="alert">
        This runtime has lost the robot: {status.lost} Only <code>segue run --take-over</code> gets it back.
      </p>
    );
  }
  const troubles = troublesOf(status);
  if (troubles.length === 0) return null;
  return (
    <section className="banner halted health" aria-label="What is wrong" role="alert">
      <ul>
        {troubles.map((one) => (
          <li key={one.kind + ' ' + one.name}>
            <strong>{one.what}</strong>, since {howLong(one.for_s)}
            {one.why && ': ' + one.why} <span className="remedy">{one.repair}</span>
          </li>
        ))}
      </ul>
      {may && (
        <ActionButton type="button" whyNot={busy ? 'repairing …' : ''} title="Requests what runs once more, so that what is missing or faulty is made anew" onClick={() => void repair()}>
          Repair
        </ActionButton>
      )}
      {problem && <span className="bad">Not repaired: {problem}</span>}
    </section>
  );
}
