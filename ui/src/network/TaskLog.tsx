// SPDX-License-Identifier: Apache-2.0
import { useLayoutEffect, useRef } from 'react';
import { addressOf } from '../address';
import { eventsOf } from '../events/filter';
import { entriesOf, outputCommand } from '../events/task_log';
import { useDocument } from '../robot/hooks';
import type { TaskReport } from '../robot/types';
import { LocalTime } from '../LocalTime';

const mostEntries = 100;

/** The log of the task and the events that name it. Stays at its end unless somebody has scrolled back. */
export function TaskLog({ report }: { report: TaskReport }) {
  const shown = useDocument('events');
  const entries = entriesOf(report.log ?? [], eventsOf(shown?.value), report.id, mostEntries);
  const list = useRef<HTMLOListElement>(null);
  const isBack = useRef(false);
  const output = outputCommand(report.host, report.process);
  const newest = entries[entries.length - 1]?.key;
  useLayoutEffect(() => {
    if (list.current && !isBack.current) list.current.scrollTop = list.current.scrollHeight;
  }, [entries.length, newest]);
  const scrolled = () => {
    const at = list.current;
    if (at) isBack.current = at.scrollTop + at.clientHeight < at.scrollHeight - 4;
  };
  return (
    <section aria-label="Log">
      <h3>Log and events of this task</h3>
      {entries.length === 0 && <p className="quiet">none</p>}
      {entries.length > 0 && (
        <ol className="log task-log" ref={list} onScroll={scrolled} tabIndex={0} aria-label="Log and events, the newest last">
          {entries.map((entry) => (
            <li key={entry.key} className={entry.isOwn ? 'level-' + entry.kind : ''}>
              <LocalTime at={Date.parse(entry.time)} from={11} />{' '}
              {entry.isOwn ? <strong>{entry.kind}</strong> : entry.kind}: {entry.text}
            </li>
          ))}
        </ol>
      )}
      <p className="quiet">
        <a href={addressOf('events', report.id)}>Older ones and search</a>
        {output && <>. All output of its process: <code>{output}</code></>}
      </p>
    </section>
  );
}
