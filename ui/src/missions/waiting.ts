// SPDX-License-Identifier: Apache-2.0
import { planOf, type Life, type Mission } from './mission';
import { stateOf, type Row, type Run } from './run';

/** "fetch/look" for a state in "fetch": "look". */
function beside(path: string, other: string): string {
  const around = path.slice(0, path.lastIndexOf('/') + 1);
  return other.startsWith(around) ? other.slice(around.length) : other;
}

/** "world at(base): made true there, relied on here" in a user's words: "fact at(base)". */
function shortReason(because: string): string {
  const words: Record<string, string> = { condition: 'outcome', world: 'fact', group: 'resource', opaque: 'whatever it touches' };
  return because
    .split('; ')
    .map((one) => {
      const [kind = '', ...rest] = (one.split(': ')[0] ?? '').split(' ');
      return kind === 'opaque' ? words['opaque'] : [words[kind] ?? kind, ...rest].join(' ');
    })
    .join(' and ');
}

function reasonsOf(row: Row, run: Run): string[] {
  return row.waits.map((wait) => beside(stateOf(row.label), run.rows[wait.row]?.label ?? 'what comes before') + ' (' + shortReason(wait.because) + ')');
}

/**
 * For what states wait that would be next: all that they come after runs or has ended. By the paths of the states. What
 * comes after something that waits itself is left out; nothing waits in a run that is not concurrent, or has ended.
 */
export function waitsOf(mission: Mission, run: Run): Map<string, string[]> {
  const waits = new Map<string, string[]>();
  const nodes = mission.state === 'ended' ? [] : (planOf(mission)?.nodes ?? []);
  const units = new Map(nodes.map((node) => [node.name, node.units ?? []]));
  for (const row of run.rows) {
    const needs = units.get(row.label);
    const path = stateOf(row.label);
    if (row.status !== 'waiting' || needs === undefined || waits.has(path)) continue;
    if (!row.waits.every((wait) => run.rows[wait.row]?.status === 'running')) continue;
    const lacks = mission.state === 'running' ? needs : []; // a mission that is paused begins nothing
    const reasons = row.waits.length > 0 ? reasonsOf(row, run) : lacks.map((one) => 'units of ' + one.resource + (one.observed ? ', as the robot shows them' : ''));
    if (reasons.length > 0) waits.set(path, reasons);
  }
  return waits;
}

/** A state waits unless it runs, also where an earlier turn of it has ended. */
export function withWaiting(lives: Map<string, Life>, waits: Map<string, string[]>): Map<string, Life> {
  const all = new Map(lives);
  for (const path of waits.keys()) {
    const life = lives.get(path);
    if (life !== 'running' && life !== 'next') all.set(path, 'waiting');
  }
  return all;
}
