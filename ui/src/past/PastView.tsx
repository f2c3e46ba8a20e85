// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from 'react';
import { useDocument } from '../robot/hooks';
import { toneOfOutcome } from '../robot/outcome';
import { eventsOf } from '../events/filter';
import type { RobotEvent } from '../robot/types';
import { ListPane } from '../panes/Panel';
import { LocalTime } from '../LocalTime';
import { FilmView } from './FilmView';
import { MomentView } from './MomentView';
import type { PastRequest } from './film';
import { timeInAddress } from './slider';
import { useRequests, useSpan, useTransition } from './usePast';
import './past.css';

function RequestLine({ request, chosen, onChoose }: { request: PastRequest; chosen: boolean; onChoose: () => void }) {
  return (
    <li>
      <button type="button" className="line" aria-pressed={chosen} onClick={onChoose} data-request={request.id}>
        <span>
          {request.from || 'empty'} → {request.to || 'empty'}
          {request.cause !== 'request' && <span className="quiet"> ({request.cause})</span>}
          <br />
          <span className="quiet"><LocalTime at={request.ended_s * 1000} to={19} /></span>
        </span>
        <span className={'badge tone-' + toneOfOutcome(request.outcome)}>{request.outcome}</span>
      </button>
    </li>
  );
}

/** The number of the newest event that the journal has an entry for. */
function newestEnd(events: RobotEvent[]): number {
  const ends = ['transition_done', 'transition_failed', 'request_refused', 'request_superseded', 'request_cancelled'];
  return events.filter((event) => ends.includes(event.kind)).pop()?.number ?? 0;
}

/** Changes with a number, and again a second later: the journal is written behind what happens. */
function useSettled(number: number): string {
  const [settled, setSettled] = useState(number);
  useEffect(() => {
    const timer = setTimeout(() => setSettled(number), 1000);
    return () => clearTimeout(timer);
  }, [number]);
  return number + ' ' + settled;
}

/** Nothing until the journal has been asked; what is wrong with it stands in the list of requests. */
function NoPast({ isEmpty, problem }: { isEmpty: boolean; problem: string | null }) {
  if (!isEmpty && problem === null) return null;
  return (
    <p className="empty">
      Films of the robot&apos;s transitions, and what ran at any time, are shown here, from its journal.{' '}
      {problem === null ? (
        <>It has nothing yet: choose a controller in <a href="#switch">Switch</a>, or run <code>segue switch CONTROLLER</code>.</>
      ) : (
        <>It cannot be read. A robot keeps one unless it was started with <code>segue run --no-journal</code>.</>
      )}
    </p>
  );
}

/** The past of the robot, from its journal: films of its transitions, and what ran at any time. */
export function PastView() {
  const events = useDocument('events');
  const changed = useSettled(newestEnd(eventsOf(events?.value)));
  const [words, setWords] = useState('');
  const [chosen, setChosen] = useState<number | null>(null);
  const [time, setTime] = useState<number | null>(() => timeInAddress(window.location.hash));
  const { requests, more, older, problem } = useRequests(words, changed);
  const { answer: span } = useSpan(changed);
  const film = useTransition(chosen);
  const transition = film.answer && film.answer.id === chosen ? film.answer : null;
  return (
    <div className="view switch past">
      <ListPane label="Past requests">
        <h2>Past requests</h2>
        <label className="search">
          <span className="hidden">Find past requests</span>
          <input type="search" placeholder="Find requests ( / )" data-search value={words} onChange={(event) => setWords(event.target.value)} />
        </label>
        {problem && <p className="bad" role="alert">{problem}</p>}
        <ul className="plain">
          {requests.map((request) => (
            <RequestLine key={request.id} request={request} chosen={request.id === chosen} onChoose={() => setChosen(request.id)} />
          ))}
        </ul>
        {requests.length === 0 && !problem && <p className="quiet">{words === '' ? 'Nothing has been requested yet.' : 'No request has these words.'}</p>}
        {more && <button type="button" onClick={older}>Older ones</button>}
      </ListPane>
      {chosen !== null ? (
        transition ? (
          <FilmView key={transition.id} transition={transition} onClose={() => setChosen(null)} />
        ) : (
          <p className="empty">{film.problem ?? ''}</p>
        )
      ) : span && span.first_s !== null ? (
        <MomentView span={span} time={time ?? span.last_s ?? 0} changed={changed} onTime={setTime} onPlay={setChosen} />
      ) : (
        <NoPast isEmpty={span !== null} problem={problem} />
      )}
    </div>
  );
}
