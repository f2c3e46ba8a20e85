// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useRef, useState } from 'react';
import { useConnection } from '../robot/hooks';
import { positionOf, type Control, type Values } from './control';
import type { Mission } from './mission';
import { numberOf } from './requests';

/** The known values of a state; `isCurrent`: the mission has not gone on since. */
export interface KnownValues {
  values: Values;
  isCurrent: boolean;
}

/**
 * Which state to ask the mission for next, and what it has answered. The document has only the latest answer to anybody, so
 * those seen here are kept. An answer counts for the position at which it was asked for; one that others asked for, for the
 * position at which it came.
 */
export class ValueAsker {
  private readonly answers = new Map<string, { values: Values | null; position: string }>();
  private pending: { path: string; position: string; number: number | null } | null = null;
  private run = 0;
  private newest = 0;

  /** Takes what the document says; again and again without harm. */
  see(run: number, control: Control, position: string): void {
    if (run !== this.run) {
      this.answers.clear();
      this.pending = null;
      this.newest = 0;
      this.run = run;
    }
    const { values, problem, heard } = control;
    if (values && values.number > this.newest) {
      this.newest = values.number;
      this.answers.set(values.of, { values, position: this.pending?.path === values.of ? this.pending.position : position });
    }
    const number = this.pending?.number ?? null;
    if (number === null || number > heard) return;
    if (problem?.number === number) this.failed();
    this.pending = null;
  }

  /** The first of these paths whose values are not those at that position; null while a question is on its way. */
  next(wanted: string[], position: string): string | null {
    if (this.pending) return null;
    return wanted.find((path) => this.answers.get(path)?.position !== position) ?? null;
  }

  asks(path: string, position: string): void {
    this.pending = { path, position, number: null };
  }
  /** The robot has taken the question, under that number. */
  took(number: number): void {
    if (this.pending) this.pending.number = number;
  }
  /** The question failed, and is not repeated at that position. */
  failed(): void {
    if (!this.pending) return;
    const { path, position } = this.pending;
    this.answers.set(path, { values: this.answers.get(path)?.values ?? null, position });
    this.pending = null;
  }

  of(path: string, position: string): KnownValues | null {
    const known = this.answers.get(path);
    return known?.values ? { values: known.values, isCurrent: known.position === position } : null;
  }
}

/** The shortest time between two questions, so that a mission that goes on fast is not kept busy by them. */
const shortestPause = 300;

/** The values of these states as far as they are known; the mission is asked for them again wherever it has gone on. */
export function useValues(mission: Mission | null, control: Control | null, wanted: string[]): (path: string) => KnownValues | null {
  const connection = useConnection();
  const asker = useRef(new ValueAsker()).current;
  const [rested, setRested] = useState(true);
  const [, setAnswered] = useState(0);
  const position = useMemo(() => (mission && control ? positionOf(mission, control) : ''), [mission, control]);
  if (mission && control) asker.see(mission.run, control, position);
  const may = control !== null && control.steps && connection.mayOperate && mission?.state !== 'stopping';
  const path = may && rested ? asker.next(wanted, position) : null;

  useEffect(() => {
    if (path === null) return;
    const answered = () => setAnswered((before) => before + 1);
    asker.asks(path, position);
    setRested(false);
    setTimeout(() => setRested(true), shortestPause);
    connection.call('mission', { what: 'values', of: path }).then(
      (answer) => [asker.took(numberOf(answer) ?? 0), answered()],
      () => [asker.failed(), answered()],
    );
  }, [asker, connection, path, position]);

  return (of) => (control ? asker.of(of, position) : null);
}
