// SPDX-License-Identifier: Apache-2.0
import { useCallback, useEffect, useMemo, useRef, useState } from 'react';
import { reason } from '../reason';
import type { Json } from '../robot/change';
import { useConnection } from '../robot/hooks';
import type { PastRequest, PastTransition } from './film';
import { isClock, type Clock } from './film_samples';

export interface Span {
  first_s: number | null;
  last_s: number | null;
  marks: { id: number; time_s: number; outcome: string }[];
}

/** The robot at a time, as far as its journal has it. */
export interface PastMoment {
  time_s: number;
  known: boolean;
  since_s: number | null;
  controller: string | null;
  version: string | null;
  network: string | null;
  transition: number | null;
  missions: { mission: string; who: string; actions: string[] }[];
  differences: string[];
  notes: string[];
}

const page = 50;

export interface Page {
  requests: PastRequest[];
  more: boolean;
}

/** Asks for the requests that have all the words: those before the one with that id, or the newest. */
function useAsk(words: string): (before: number | null) => Promise<Page> {
  const connection = useConnection();
  return useCallback(
    async (before: number | null) => {
      const question: { [key: string]: Json } = { ask: 'requests', limit: page, words: words.slice(0, 200) };
      if (before !== null) question['before'] = before;
      return (await connection.call('past', question)) as unknown as Page;
    },
    [connection, words],
  );
}

/** The requests that have all the words, newest first, and more of them as they are asked for. Asked anew where `changed` does. */
export function useRequests(words: string, changed: string) {
  const ask = useAsk(words);
  const [{ requests, more }, setShown] = useState<Page>({ requests: [], more: false });
  const [problem, setProblem] = useState<string | null>(null);
  const shownWords = useRef('');

  useEffect(() => {
    let current = true;
    ask(null).then(
      (answer) => {
        if (!current) return;
        setProblem(null);
        const isSame = shownWords.current === words;
        setShown((before) => withFirst(answer, isSame ? before : null));
        shownWords.current = words;
      },
      (error: unknown) => {
        if (current) setProblem(reason(error));
      },
    );
    return () => {
      current = false;
    };
  }, [ask, words, changed]);

  const older = () => {
    const last = requests[requests.length - 1];
    if (!last) return;
    ask(last.id).then(
      (answer) => {
        if (shownWords.current === words) setShown((before) => withOlder(before, answer));
      },
      (error: unknown) => setProblem(reason(error)),
    );
  };
  return { requests, more, older, problem };
}

/**
 * The first page anew; pages behind it that were loaded before stay. The list does not grow by this: the oldest leave it, since a page
 * may stay open at a robot that switches all day.
 */
export function withFirst(first: Page, before: Page | null): Page {
  const last = first.requests[first.requests.length - 1]?.id ?? 0;
  const behind = before && first.more ? before.requests.filter((one) => one.id < last) : [];
  const all = [...first.requests, ...behind];
  const kept = all.slice(0, Math.max(page, before?.requests.length ?? 0));
  const isMore = before && behind.length > 0 ? before.more : first.more;
  return { requests: kept, more: isMore || kept.length < all.length };
}

function withOlder(before: Page, older: Page): Page {
  const added = older.requests.filter((one) => !before.requests.some((known) => known.id === one.id));
  return { requests: [...before.requests, ...added], more: older.more };
}

/** One answer; null until it is there, or where nothing is asked. The one before stays until the next has come. */
function useAnswer<Answer>(question: { [key: string]: Json } | null, changed = ''): { answer: Answer | null; problem: string | null } {
  const connection = useConnection();
  const [found, setFound] = useState<{ answer: Answer | null; problem: string | null }>({ answer: null, problem: null });
  const text = question === null ? null : JSON.stringify(question);
  useEffect(() => {
    if (text === null) {
      setFound({ answer: null, problem: null });
      return;
    }
    let current = true;
    connection.call('past', JSON.parse(text) as { [key: string]: Json }).then(
      (answer) => {
        if (current) setFound({ answer: answer as unknown as Answer, problem: null });
      },
      (error: unknown) => {
        if (current) setFound({ answer: null, problem: reason(error) });
      },
    );
    return () => {
      current = false;
    };
  }, [connection, text, changed]);
  return found;
}

export function useTransition(id: number | null) {
  return useAnswer<PastTransition>(id === null ? null : { ask: 'request', id });
}

export function useSpan(changed: string) {
  return useAnswer<Span>({ ask: 'span' }, changed);
}

export function useMoment(time: number | null, changed: string) {
  return useAnswer<PastMoment>(time === null ? null : { ask: 'at', time_s: time }, changed);
}

/** The robot's clock beside that of samples; or why it is not known. Both null until the answer is there. */
export function useClock(): { clock: Clock | null; problem: string | null } {
  const { answer, problem } = useAnswer<unknown>({ ask: 'clock' });
  return useMemo(() => ({ clock: isClock(answer) ? answer : null, problem: answer !== null && !isClock(answer) ? 'it runs an older Segue' : problem }), [answer, problem]);
}
