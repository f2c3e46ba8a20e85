// SPDX-License-Identifier: Apache-2.0
import { useCallback, useEffect, useMemo, useRef, useState } from 'react';
import type { Json } from '../robot/change';
import { useConnection } from '../robot/hooks';
import type { Control, Step } from './control';
import type { Mission } from './mission';

/** The requests of the verb "mission". */
export type Request =
  | { what: 'pause' | 'resume' | 'stop' }
  | { what: 'step'; how: Step }
  | { what: 'break'; at: string[] }
  | { what: 'go_on_at'; at: string };

/** A request of this page on its way: `number` is null until the robot has taken it. */
export interface Asked {
  id: number;
  request: Request;
  number: number | null;
  /** The run and its state when it was asked. */
  run: number;
  state: string;
}

/**
 * The requests that the mission has not heard yet; of one that does not say what it has heard, those since its last
 * change of state.
 */
export function unheard(asked: Asked[], mission: Mission, control: Control | null): Asked[] {
  return asked.filter((one) => {
    if (one.run !== mission.run || mission.state === 'ended') return false;
    if (!control) return one.state === mission.state;
    return one.number === null || one.number > control.heard;
  });
}

/** The breakpoints once all is heard. */
export function breakpointsAfter(asked: Asked[], control: Control): string[] {
  const last = asked.flatMap((one) => (one.request.what === 'break' ? [one.request.at] : [])).pop();
  return last ?? control.breakpoints;
}

/** "asked to …" */
export function wordsOf(request: Request): string {
  if (request.what === 'step') return 'step ' + request.how;
  if (request.what === 'break') return 'change breakpoints';
  return request.what === 'go_on_at' ? 'go on at ' + request.at : request.what;
}

/** A request that was refused before this page came, and others were heard since: its number; 0: there is none. */
export function oldProblem(control: Control): number {
  const number = control.problem?.number ?? 0;
  return number < control.heard ? number : 0;
}

export interface Requests {
  /** Whether this browser may ask for anything. */
  may: boolean;
  asked: Asked[];
  /** Why the last request was refused, whoever made it; "": it was not. */
  problem: string;
  ask: (request: Request) => void;
  /** The problem has been read. */
  dismiss: () => void;
}

/** How long a request to a mission that does not say what it has heard is shown. */
const longestAsked = 5000;

/** This page's requests to the mission. Their results are in the document, for all pages alike. */
export function useRequests(mission: Mission | null, control: Control | null): Requests {
  const connection = useConnection();
  const [all, setAll] = useState<Asked[]>([]);
  const [failure, setFailure] = useState('');
  const [read, setRead] = useState({ run: 0, number: 0 });
  const run = mission?.run ?? 0;
  const state = mission?.state ?? 'ended';
  const asked = useMemo(() => (mission ? unheard(all, mission, control) : []), [all, mission, control]);
  const says = control !== null;

  useEffect(() => {
    if (asked.length < all.length) setAll(asked);
  }, [asked, all]);
  // Somebody else may have asked for the opposite before this browser saw the result of its own request.
  useEffect(() => {
    if (says || asked.length === 0) return;
    const timer = setTimeout(() => setAll([]), longestAsked);
    return () => clearTimeout(timer);
  }, [says, asked]);

  const seen = control?.problem?.number ?? 0;
  const old = useRef({ run: 0, number: 0 });
  if (control && old.current.run !== run) old.current = { run, number: oldProblem(control) };
  const dismiss = useCallback(() => {
    setRead({ run, number: seen });
    setFailure('');
  }, [run, seen]);

  const ask = useCallback(
    (request: Request) => {
      const id = nextId();
      dismiss();
      setAll((before) => [...before, { id, request, number: null, run, state }]);
      connection.call('mission', { ...request }).then(
        (answer) => setAll((before) => before.map((one) => (one.id === id ? { ...one, number: numberOf(answer) ?? 0 } : one))),
        (error: Error) => [setFailure(error.message), setAll((before) => before.filter((one) => one.id !== id))],
      );
    },
    [connection, dismiss, run, state],
  );

  const known = Math.max(old.current.run === run ? old.current.number : 0, read.run === run ? read.number : 0);
  const refused = control?.problem && control.problem.number > known ? control.problem.text : '';
  return { may: connection.mayOperate, asked, problem: failure || refused, ask, dismiss };
}

let lastId = 0;
const nextId = (): number => ++lastId;

/** "number" of the verb's answer. */
export function numberOf(answer: Json): number | null {
  const number = typeof answer === 'object' && answer !== null && !Array.isArray(answer) ? answer['number'] : null;
  return typeof number === 'number' ? number : null;
}
