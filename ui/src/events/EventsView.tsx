// SPDX-License-Identifier: Apache-2.0
import { useMemo, useState } from 'react';
import { useDocument } from '../robot/hooks';
import { Skipped } from '../robot/Skipped';
import { LocalTime } from '../LocalTime';
import { eventsOf, isTrouble, withWords, wordsOfAddress } from './filter';

const mostLines = 500;

function NoEvents({ isFiltered }: { isFiltered: boolean }) {
  return (
    <p className="empty">
      {isFiltered ? (
        <>No event fits: take words out of the search, or the mark from <em>only trouble</em>.</>
      ) : (
        <>What happens to the robot is listed here as soon as it is heard: requests, actions of transitions, and trouble. <code>segue run ROBOT --controller CONTROLLER</code> starts it.</>
      )}
    </p>
  );
}

export function EventsView() {
  const shown = useDocument('events');
  const [words, setWords] = useState(() => wordsOfAddress(window.location.hash));
  const [onlyTrouble, setOnlyTrouble] = useState(false);
  const all = useMemo(() => eventsOf(shown?.value), [shown]);
  const found = withWords(all, words).filter((event) => !onlyTrouble || isTrouble(event));
  return (
    <section className="view" aria-label="Events">
      <div className="bar">
        <label className="search">
          <span className="hidden">Find events</span>
          <input type="search" placeholder="Find events ( / )" data-search value={words} onChange={(event) => setWords(event.target.value)} />
        </label>
        <label>
          <input type="checkbox" checked={onlyTrouble} onChange={(event) => setOnlyTrouble(event.target.checked)} /> only trouble
        </label>
        <span className="quiet">{found.length} of {all.length}, the newest first</span>
        <Skipped count={shown?.skipped} />
      </div>
      <div className="scroll" tabIndex={0} role="region" aria-label="List of events">
        <table>
          <thead>
            <tr><th scope="col">Number</th><th scope="col">Time</th><th scope="col">Kind</th><th scope="col">Subject</th><th scope="col">Message</th></tr>
          </thead>
          <tbody>
            {found.slice(-mostLines).reverse().map((event) => (
              <tr key={event.number} className={isTrouble(event) ? 'trouble' : ''}>
                <td className="number">{event.number}</td>
                <td><LocalTime at={Date.parse(event.time)} /></td>
                <td>{event.kind}</td>
                <td>{event.subject}</td>
                <td>{event.message}</td>
              </tr>
            ))}
          </tbody>
        </table>
        {found.length === 0 && <NoEvents isFiltered={all.length > 0} />}
        {found.length > mostLines && <p className="quiet">Older ones are not shown; search for them.</p>}
      </div>
    </section>
  );
}
