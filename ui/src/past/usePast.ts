// SPDX-License-Identifier: Apache-2.0
import { useCallback, useEffect, useRef, useState } from 'react';
import type { Json } from '../robot/change';
import { useConnection } from '../robot/hooks';
import type { PastRequest, PastTransition } from './film';

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

function said(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}

/** The requests that have all the words, newest first, and more of them as they are asked for. Asked anew where `changed` does. */
export function useRequests(words: string, changed: string) {
  const connection = useConnection();
  const [requests, setRequests] = useState<PastRequest[]>([]);
  const [more, setMore] = useState(false);
  const [problem, setProblem] = useState<string | null>(null);
  const asked = useRef<{ words: string; requests: PastRequest[] }>({ words: '', requests: [] });
  asked.current.requests = requests;

  const ask = useCallback(
    async (before: number | null) => {
      const question: { [key: string]: Json } = { ask: 'requests', limit: page, words: words.slice(0, 200) };
      if (before !== null) question['before'] = before;
      return (await connection.call('past', question)) as unknown as { requests: PastRequest[]; more: boolean };
    },
    [connection, words],
  );

  useEffect(() => {
    let current = true;
    ask(null).then(
      (answer) => {
        if (!current) return;
        setProblem(null);
        // Requests that were loaded behind the first page stay.
        const last = answer.requests[answer.requests.length - 1]?.id ?? 0;
        const behind = asked.current.words === words && answer.more ? asked.current.requests.filter((one) => one.id < last) : [];
        if (behind.length === 0) setMore(answer.more);
        setRequests([...answer.requests, ...behind]);
        asked.current.words = words;
      },
      (error: unknown) => {
        if (current) setProblem(said(error));
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
        if (asked.current.words !== words) return;
        setRequests((now) => [...now, ...answer.requests.filter((one) => !now.some((known) => known.id === one.id))]);
        setMore(answer.more);
      },
      (error: unknown) => setProblem(said(error)),
    );
  };
  return { requests, more, older, problem };
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
        if (current) setFound({ answer: null, problem: said(error) });
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
