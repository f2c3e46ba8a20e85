// SPDX-License-Identifier: Apache-2.0
import { Skipped } from '../robot/Skipped';
import type { SampleState } from './samples';

/** Notes on the samples of a panel: errors, pauses and skipped samples. */
export function Footer({ state, paused, problem }: { state: SampleState; paused: boolean; problem?: string }) {
  return (
    <p className="panel-notes">
      {problem && <span className="bad">{problem}</span>}
      {state.errors.map((error) => <span key={error} className="bad">{error}</span>)}
      {paused && <span>Paused: nothing is asked of the robot.</span>}
      {!paused && state.waiting && <span>Waiting for a sample …</span>}
      {!paused && state.period > 0 && <span>Large samples: one in {state.period.toFixed(1)} s at the most.</span>}
      <Skipped count={state.skipped} />
    </p>
  );
}
