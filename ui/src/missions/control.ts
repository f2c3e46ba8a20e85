// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json } from '../robot/change';
import { entriesOf, pathsTo, type Life, type Mission } from './mission';

/** A value at a port of a state. */
export interface PortValue {
  name: string;
  type: string;
  /** JSON, or the beginning of it where it is cut. */
  text: string;
  cut: boolean;
}

/** The answer to a question for the values of a state. */
export interface Values {
  number: number;
  of: string;
  /** "running", "ended", "next", or "" where its container does not run. */
  when: string;
  inputs: PortValue[];
  outputs: PortValue[];
}

/** How a mission that runs can be steered (segue/control/robot_service.hpp). */
export interface Control {
  /** It can be stepped, has breakpoints, and can go on elsewhere. */
  steps: boolean;
  /** It can be stepped back. */
  back: boolean;
  /** null: it goes on; else it is at rest before these states. */
  at: string[] | null;
  breakpoints: string[];
  /** The number of the last request that it has followed or refused. */
  heard: number;
  /** The last request that it has refused. */
  problem?: { number: number; text: string };
  /** The latest answer. */
  values?: Values;
}

const texts = (value: Json | undefined): string[] | null => (Array.isArray(value) && value.every((one) => typeof one === 'string') ? (value as string[]) : null);
const word = (value: Json | undefined): string => (typeof value === 'string' ? value : '');

function portsOf(value: Json | undefined): PortValue[] {
  const list = Array.isArray(value) ? value.filter(isMap) : [];
  return list.map((one) => ({ name: word(one['name']), type: word(one['type']), text: word(one['text']), cut: one['cut'] === true }));
}

/** Null where the mission has ended, or the program that runs it does not say how it can be steered. */
export function controlOf(mission: Mission | null): Control | null {
  const control = mission?.control;
  if (!isMap(control) || typeof control['heard'] !== 'number' || mission?.state === 'ended') return null;
  const { problem, values } = control;
  return {
    steps: control['steps'] === true,
    back: control['back'] === true,
    at: texts(control['at']),
    breakpoints: texts(control['breakpoints']) ?? [],
    heard: control['heard'],
    problem: isMap(problem) && typeof problem['number'] === 'number' ? { number: problem['number'], text: word(problem['text']) } : undefined,
    values:
      isMap(values) && typeof values['number'] === 'number' && typeof values['of'] === 'string'
        ? { number: values['number'], of: values['of'], when: word(values['when']), inputs: portsOf(values['inputs']), outputs: portsOf(values['outputs']) }
        : undefined,
  };
}

/** Changes whenever values may: something has begun or ended, or the mission is held elsewhere. */
export function positionOf(mission: Mission, control: Control): string {
  const entries = entriesOf(mission);
  return JSON.stringify([mission.run, control.at, entries[entries.length - 1]?.number ?? 0]);
}

export type Step = 'into' | 'over' | 'out' | 'back';

/** A button of the bar, and the key that does the same. */
export interface StepButton {
  how: Step;
  label: string;
  key: string;
  title: string;
  /** Why it cannot be used; "": it can. */
  reason: string;
}

/** The keys are those of gdb; r for reverse. */
const steps: { how: Step; label: string; key: string; title: string }[] = [
  { how: 'into', label: 'Into', key: 's', title: 'Goes on by one state, into it where it is a container' },
  { how: 'over', label: 'Over', key: 'n', title: 'Goes on by one state with everything in it' },
  { how: 'out', label: 'Out', key: 'f', title: 'Goes on to the end of the container' },
  { how: 'back', label: 'Back', key: 'r', title: 'Undoes the last action' },
];

/** `busy`: something that was asked for has not been heard yet. */
export function stepButtons(state: string, control: Control, busy: boolean): StepButton[] {
  const held = control.at !== null;
  return steps.map((step) => {
    const reason =
      step.how === 'back' && !control.back ? 'the mission was started without --steps-back'
      : state === 'stopping' ? 'the mission is being stopped'
      : state === 'paused' && !held ? 'what is under way has not ended yet'
      : !held ? 'the mission must be paused first'
      : busy ? 'the mission has not heard yet what it was asked for'
      : '';
    return { ...step, reason };
  });
}

/** The containers around a state from the innermost one that runs, which going on there begins at another state, on inward. */
function begunBy(path: string, lives: Map<string, Life>): string[] {
  const containers = ['', ...pathsTo(path).slice(0, -1)];
  const idle = containers.findIndex((container) => container !== '' && lives.get(container) !== 'running');
  return containers.slice((idle < 0 ? containers.length : idle) - 1);
}

/** The states that run in the innermost container around that state that runs: going on at the state preempts them. */
export function preemptedBy(path: string, lives: Map<string, Life>): string[] {
  const around = begunBy(path, lives)[0] ?? '';
  const inside = around === '' ? '' : around + '/';
  return [...lives].flatMap(([other, life]) => (life === 'running' && other !== '' && other.startsWith(inside) && !other.slice(inside.length).includes('/') ? [other] : []));
}

/** Why the mission cannot go on at that state; "": it can. */
export function whyNotAt(path: string, lives: Map<string, Life>, kinds: Map<string, string>): string {
  const concurrent = begunBy(path, lives).some((container) => ['barrier', 'preemptive'].includes(kinds.get(container) ?? ''));
  return concurrent ? 'a concurrent state begins together with those beside it; go on at their container, or in one of them that runs' : '';
}

/** The breakpoints with that state, or without it where there was one. */
export function withToggled(breakpoints: string[], path: string): string[] {
  return breakpoints.includes(path) ? breakpoints.filter((one) => one !== path) : [...breakpoints, path];
}
