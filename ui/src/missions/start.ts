// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json } from '../robot/change';
import { runOfDocument, type Run } from './run';

/** An input of a mission that can be started. */
export interface MissionInput {
  name: string;
  type: string;
  default: Json;
}

/** The answer of the verb "mission_form" (segue/web/mission_starts.hpp). */
export interface MissionForm {
  mission: string;
  description: string;
  inputs: MissionInput[];
  needs_robot: boolean;
}

export type Mode = 'sequential' | 'concurrent' | 'strict';
export const modes: { mode: Mode; label: string; means: string }[] = [
  { mode: 'sequential', label: 'Sequential', means: 'As it is written; it can be stepped.' },
  { mode: 'concurrent', label: 'Concurrent, ahead of time', means: 'What need not wait for each other runs at once, also before it is certain to count. It can be paused, not stepped.' },
  { mode: 'strict', label: 'Concurrent, strict', means: 'What need not wait for each other runs at once, but nothing while something before it may fail. It can be paused, not stepped.' },
];

/** The paths of missions that can be started, from the answer of the verb "files". */
export function missionsIn(answer: Json): string[] {
  const files = isMap(answer) && Array.isArray(answer['files']) ? answer['files'].filter(isMap) : [];
  return files.filter((file) => file['kind'] === 'mission' && file['problem'] === '').map((file) => String(file['path']));
}

/** A default as a field shows it; nothing: ''. */
export function defaultText({ type, default: value }: MissionInput): string {
  if (value === null || value === undefined) return '';
  return type === 'text' && typeof value === 'string' ? value : JSON.stringify(value);
}

/** Why a number or truth value cannot be meant by a text, in words; null: it can, as far as the page knows. The studio checks the rest. */
export function inputProblem(type: string, text: string): string | null {
  const trimmed = text.trim();
  if (type === 'text' || trimmed === '') return null;
  if (type === 'int' && !/^[+-]?(0x[0-9a-fA-F]+|0o[0-7]+|\d+)$/.test(trimmed)) return 'a whole number is needed, such as 3';
  if (type === 'float' && !/^[+-]?(\.\d+|\d+(\.\d*)?)([eE][+-]?\d+)?$|^[+-]?\.inf$|^\.nan$/i.test(trimmed)) return 'a number is needed, such as 0.5';
  if (type === 'list' && !/^[[-]/.test(trimmed)) return 'a list is needed, such as [1, 2]';
  if (type === 'map' && !/^\{|:(\s|$)/.test(trimmed)) return 'a map is needed, such as {x: 1, y: 2}';
  return null;
}

/** The texts to send: those of fields that somebody has edited. Of one that is empty again, the default counts, unless it is a text. */
export function givenInputs(form: MissionForm, typed: Record<string, string>): Record<string, string> {
  const given: Record<string, string> = {};
  for (const { name, type } of form.inputs) {
    const text = typed[name];
    if (text !== undefined && (type === 'text' || text.trim() !== '')) given[name] = text;
  }
  return given;
}

/** The fields that cannot be meant as they are. */
export function problemsOf(form: MissionForm, typed: Record<string, string>): Record<string, string> {
  const found: Record<string, string> = {};
  for (const { name, type } of form.inputs) {
    const problem = inputProblem(type, typed[name] ?? '');
    if (problem !== null) found[name] = problem;
  }
  return found;
}

/** The result of a request to start a mission. */
export type Started = { problems: Record<string, string> } | { simulated: Run } | 'begun';

/** From the answer of the verb "start_mission". */
export function startedOf(answer: Json): Started {
  if (!isMap(answer)) return 'begun';
  const { problems, run } = answer;
  if (isMap(problems)) return { problems: Object.fromEntries(Object.entries(problems).map(([name, text]) => [name, String(text)])) };
  if (run === null || run === undefined) return 'begun';
  return { simulated: runOfDocument(run) };
}
