// SPDX-License-Identifier: Apache-2.0
import { useState } from 'react';
import { LocalTime } from '../LocalTime';
import { ListPane } from '../panes/Panel';
import { reason } from '../reason';
import type { Mission } from './mission';
import { endOf, lastedText, usePastRuns, type PastRun } from './past_runs';
import type { Run } from './run';

function RunLine({ run, runs, chosen, onChoose }: { run: PastRun; runs: boolean; chosen: boolean; onChoose: () => void }) {
  const { text, tone } = endOf(run, runs);
  return (
    <li>
      <button type="button" className="line" aria-pressed={chosen} onClick={onChoose} data-run={run.id} title={'by ' + run.who + (run.error ? ': ' + run.error : '')}>
        <span>{run.mission}</span>
        <span className={'badge tone-' + tone}>{text}</span>
        <span className="quiet when">
          <LocalTime at={run.began_s * 1000} to={19} />
          <br />
          {[run.mode, run.ended_s === null ? '' : lastedText(run.ended_s - run.began_s)].filter((part) => part !== '').join(', ')}
        </span>
      </button>
    </li>
  );
}

interface Props {
  /** The mission that commands or has commanded the robot. */
  mission: Mission | null;
  chosen: number | null;
  /** `ended`: how it ended, in words. */
  onOpen: (run: Run, id: number, ended: string) => void;
  /** The run that was chosen is the one that goes on. */
  onLive: () => void;
}

/** The pane with the recent runs of missions, from the journal of the robot. */
export function PastRuns({ mission, chosen, onOpen, onLive }: Props) {
  const { missions, more, older, open, problem } = usePastRuns(mission ? mission.run + ' ' + (mission.state === 'ended') : '');
  const [failure, setFailure] = useState('');
  const isLive = (run: PastRun, index: number) => index === 0 && run.ended_s === null && mission !== null && mission.state !== 'ended';
  const choose = async (run: PastRun, index: number) => {
    setFailure('');
    if (isLive(run, index)) return onLive();
    try {
      onOpen(await open(run.id), run.id, endOf(run, false).text + (run.error ? ': ' + run.error : ''));
    } catch (error) {
      setFailure(reason(error));
    }
  };
  return (
    <ListPane label="Past runs">
      <h2>Past runs</h2>
      {(problem || failure) && <p className="bad" role="alert">{problem || failure}</p>}
      <ul className="plain past-runs">
        {missions.map((run, index) => (
          <RunLine key={run.id} run={run} runs={isLive(run, index)} chosen={run.id === chosen} onChoose={() => void choose(run, index)} />
        ))}
      </ul>
      {missions.length === 0 && !problem && <p className="quiet">No mission has run on this robot yet.</p>}
      {more && <button type="button" onClick={older}>Older ones</button>}
    </ListPane>
  );
}
