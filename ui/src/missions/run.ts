// SPDX-License-Identifier: Apache-2.0
import { reason } from '../reason';
import { isMap, type Json, type JsonMap } from '../robot/change';
import { containersIn, entriesOf, planOf, type Mission, type PlanNode } from './mission';

export type RowStatus = 'waiting' | 'running' | 'done' | 'failed' | 'preempted' | 'skipped' | 'discarded' | 'lost';

/** One run of a node; times in seconds since the run began. */
export interface Bar {
  from: number;
  /** Infinity: it runs. */
  until: number;
  discarded: boolean;
}

export interface Wait {
  /** Position of the row that it waits for; -1: none. */
  row: number;
  kind: string;
  because: string;
  from: number;
  until: number;
}

export interface Row {
  label: string;
  status: RowStatus;
  outcome: string;
  error: string;
  /** Part of the longest chain of nodes that waited for each other. */
  critical: boolean;
  /** The run began before it was certain to count, and counts. */
  ahead: boolean;
  bars: Bar[];
  waits: Wait[];
}

/** A run as a Gantt chart shows it. */
export interface Run {
  name: string;
  /** Seconds since 1970; null: a run that was recorded, without a date. */
  began: number | null;
  ended: boolean;
  rows: Row[];
  /** The end of the last bar that has one. */
  until: number;
}

/** The state of which a row of the chart is one turn. */
export const stateOf = (label: string): string => label.replace(/#\d+$/, '');

const noRole = new Set(['join', 'copy', 'global']);

interface Look {
  off: boolean;
  blockers: Map<number, string>;
}

/** Which nodes wait for which others, and which are not on the way that is taken, as far as that is known. */
function looksOf(nodes: PlanNode[], rowOf: (node: number) => Row | undefined): Look[] {
  const looks: Look[] = [];
  for (const node of nodes) {
    const own: Look = { off: false, blockers: new Map() };
    const anyWay = node.role === 'join';
    for (const { node: from, kind, subject, because, holds_start } of node.after) {
      const before = looks[from];
      const other = nodes[from];
      if (!before || !other) continue;
      const row = rowOf(from);
      const conditional = kind === 'condition' && !anyWay;
      if (before.off) own.off ||= conditional;
      else if (noRole.has(other.role)) for (const [blocker, why] of before.blockers) own.blockers.set(blocker, why);
      else if (!row || row.status === 'waiting' || row.status === 'running') {
        if (holds_start) own.blockers.set(from, because);
      } else if (conditional && row.outcome !== subject) own.off = true;
    }
    looks.push(own);
  }
  return looks;
}

function emptyRow(label: string): Row {
  return { label, status: 'waiting', outcome: '', error: '', critical: false, ahead: false, bars: [], waits: [] };
}

function statusOf(outcome: string): RowStatus {
  return outcome === 'aborted' ? 'failed' : outcome === 'preempted' ? 'preempted' : outcome === 'lost' ? 'lost' : 'done';
}

/** Marks the row that ended last, the row that it waited for last, and so on back to the beginning. */
function markCritical(rows: Row[]): void {
  let last: Row | undefined;
  for (const row of rows) {
    if (row.bars.length > 0 && (!last || endOf(row) >= endOf(last))) last = row;
  }
  while (last && !last.critical) {
    last.critical = true;
    const wait: Wait | undefined = last.waits[last.waits.length - 1];
    last = wait ? rows[wait.row] : undefined;
  }
}

function endOf(row: Row): number {
  return row.bars[row.bars.length - 1]?.until ?? 0;
}

function startOf(row: Row): number {
  return row.bars[row.bars.length - 1]?.from ?? 0;
}

/**
 * The wait of a node that has begun: for the candidate that ended last before. In a sequential run the candidates are
 * the nodes before it.
 */
function lastWait(row: Row, rows: Row[], candidates: { row: number; kind: string; because: string }[]): Wait[] {
  const start = startOf(row);
  let found: Wait | null = null;
  for (const candidate of candidates) {
    const other = rows[candidate.row];
    if (!other || other === row || other.bars.length === 0) continue;
    const end = endOf(other);
    if (end <= start && (!found || end > found.until)) found = { ...candidate, from: startOf(other), until: end };
  }
  return found ? [found] : [];
}

/** The run of the mission that runs at the robot, or of the last one that did. */
export function runOfMission(mission: Mission): Run {
  const entries = entriesOf(mission);
  const began = entries[0]?.time_s ?? 0;
  const nodes = planOf(mission)?.nodes ?? [];
  const rows: Row[] = [];
  const byLabel = new Map<string, number>();
  const rowFor = (label: string): number => {
    const known = byLabel.get(label);
    if (known !== undefined) return known;
    byLabel.set(label, rows.length);
    rows.push(emptyRow(label));
    return rows.length - 1;
  };
  const containers = containersIn(entries);
  const rowOfNode = nodes.map((node) => (noRole.has(node.role) ? -1 : rowFor(node.name)));
  const order: number[] = [];
  let until = 0;
  for (const entry of entries) {
    if (entry.action === '' || entry.kind === 'asked' || containers.has(entry.action)) continue;
    const index = rowFor(entry.iteration > 0 ? entry.action + '#' + entry.iteration : entry.action);
    const row = rows[index] as Row;
    const time = entry.time_s - began;
    const open = row.bars[row.bars.length - 1];
    until = Math.max(until, time);
    if (entry.kind === 'began') {
      if (open && open.until === Infinity) [open.until, open.discarded] = [time, true];
      row.bars.push({ from: time, until: Infinity, discarded: false });
      row.status = 'running';
      order.push(index);
    } else {
      if (open) open.until = time;
      row.status = statusOf(entry.outcome ?? '');
      row.outcome = entry.outcome ?? '';
      row.error = entry.error ?? '';
    }
  }
  const ended = mission.state === 'ended';
  const end = ended ? Math.max(until, (entries[entries.length - 1]?.time_s ?? 0) - began) : until;
  explain(rows, nodes, rowOfNode, order, end);
  if (ended) close(rows, end, mission.outcome === 'lost');
  markCritical(rows);
  return { name: mission.mission, began, ended, rows, until: end };
}

function explain(rows: Row[], nodes: PlanNode[], rowOfNode: number[], order: number[], now: number): void {
  const rowAt = (node: number) => rows[rowOfNode[node] ?? -1];
  const looks = looksOf(nodes, rowAt);
  nodes.forEach((node, index) => {
    const row = rowAt(index);
    const look = looks[index];
    if (!row || !look) return;
    if (look.off && row.status === 'waiting') row.status = 'skipped';
    if (look.off && row.status === 'running') discard(row, now);
    if (row.status === 'waiting') {
      row.waits = [...look.blockers].map(([from, because]) => {
        const blocker = rowOfNode[from] ?? -1;
        return { row: blocker, kind: because.split(' ')[0] ?? '', because, from: 0, until: Infinity };
      });
    } else if (row.bars.length > 0) {
      const reasons = reasonsOf(node, nodes, rowOfNode);
      row.waits = lastWait(row, rows, reasons);
      row.ahead = row.status === 'done' && reasons.some((reason) => reason.kind !== 'resource' && endOf(rows[reason.row] ?? row) > startOf(row) && reason.row !== rowOfNode[index]);
    }
  });
  // Nothing is known of those that are not planned: sequentially, each comes after the one that ended last.
  const planned = new Set(rowOfNode);
  order.forEach((index, at) => {
    const row = rows[index] as Row;
    if (planned.has(index) || row.waits.length > 0) return;
    const before = order.slice(Math.max(0, at - 32), at).map((other) => ({ row: other, kind: 'turn', because: 'its outcome leads here' }));
    row.waits = lastWait(row, rows, before);
  });
}

/** The actions that a node comes after, also through nodes that are not actions. */
function reasonsOf(node: PlanNode, nodes: PlanNode[], rowOfNode: number[]): { row: number; kind: string; because: string }[] {
  const found: { row: number; kind: string; because: string }[] = [];
  const seen = new Set<number>();
  const visit = (after: PlanNode['after'], why: string | null) => {
    for (const { node: from, kind, because } of after) {
      const row = rowOfNode[from] ?? -1;
      if (row >= 0) found.push({ row, kind, because: why ?? because });
      else if (!seen.has(from)) {
        seen.add(from);
        visit(nodes[from]?.after ?? [], why ?? because);
      }
    }
  };
  visit(node.after, null);
  return found;
}

function discard(row: Row, now: number): void {
  const open = row.bars[row.bars.length - 1];
  if (open) open.discarded = true;
  if (open && open.until === Infinity) open.until = now;
  row.status = 'discarded';
}

/** Nothing runs or waits any more. */
function close(rows: Row[], end: number, lost: boolean): void {
  for (const row of rows) {
    if (row.status === 'waiting') [row.status, row.waits] = ['skipped', []];
    if (row.status !== 'running') continue;
    if (!lost) discard(row, end);
    const open = row.bars[row.bars.length - 1];
    if (open && open.until === Infinity) open.until = end;
    if (lost) row.status = 'lost';
  }
}

const statuses: Record<string, RowStatus> = {
  done: 'done', skipped: 'skipped', failed: 'failed', preempted: 'preempted', 'not-reached': 'skipped', 'not reached': 'skipped',
};

const text = (value: Json | undefined): string => (typeof value === 'string' ? value : '');
const number = (value: Json | undefined): number => (typeof value === 'number' && Number.isFinite(value) ? value : 0);

/** The run in the output of `segue mission run --format json`; throws an Error that says what is wrong with it. */
export function runOfFile(content: string): Run {
  let document: Json;
  try {
    document = JSON.parse(content) as Json;
  } catch (error) {
    throw new Error('this is not JSON: ' + reason(error));
  }
  return runOfDocument(document);
}

/** The same of the document; throws an Error, too. */
export function runOfDocument(document: Json): Run {
  if (!isMap(document) || !Array.isArray(document['nodes']))
    throw new Error('this is not a run; segue mission run FILE --format json prints one');
  const nodes = document['nodes'].filter(isMap);
  const labels = nodes.map((node) => text(node['name']) + (number(node['iteration']) > 0 ? '#' + number(node['iteration']) : ''));
  const positions = new Map<string, number>();
  labels.forEach((label, index) => positions.set(label, index));
  nodes.forEach((node, index) => {
    if (!positions.has(text(node['name']))) positions.set(text(node['name']), index);
  });
  const rows = nodes.map((node, index) => recordedRow(node, labels[index] ?? '', positions));
  markCritical(rows);
  const until = rows.reduce((last, row) => Math.max(last, endOf(row)), number(document['makespan_s']));
  return { name: text(document['name']) || 'a recorded run', began: null, ended: true, rows, until };
}

function recordedRow(node: JsonMap, label: string, positions: Map<string, number>): Row {
  const row = emptyRow(label);
  row.status = statuses[text(node['status'])] ?? 'done';
  row.outcome = text(node['outcome']);
  row.error = text(node['error']);
  row.ahead = row.status === 'done' && number(node['commit_s']) > number(node['end_s']);
  const started = node['start_s'] !== undefined && node['start_s'] !== null;
  const discarded = row.status === 'skipped';
  if (started && (row.status !== 'skipped' || number(node['end_s']) > number(node['start_s']))) {
    row.bars.push({ from: number(node['start_s']), until: number(node['end_s']), discarded });
    if (discarded) row.status = 'discarded';
  }
  for (const wait of Array.isArray(node['waited_for']) ? node['waited_for'].filter(isMap) : []) {
    row.waits.push({
      row: positions.get(text(wait['node'])) ?? -1,
      kind: text(wait['kind']),
      because: (text(wait['kind']) + ' ' + text(wait['subject'])).trim(),
      from: number(wait['from_s']),
      until: number(wait['until_s']),
    });
  }
  return row;
}
