// SPDX-License-Identifier: Apache-2.0
import { isMap, type Json } from './change';

/** The robot's documents, as far as the page reads them (segue/control/robot_service.hpp). */
export interface TaskStatus {
  id: string;
  component: string;
  state: string;
  state_name: string;
  host: string;
  process: string;
  pid: number;
  cycle_us: number;
  worst_us: number;
  cycles: number;
  missed: number;
  error: string;
}

export interface ConnectionStatus {
  from: string;
  to: string;
  policy: string;
  size: number;
  written: number;
  read: number;
  dropped: number;
  /** How many samples the next two are of; none where the robot runs an older Segue. */
  measured?: number;
  /** The time from the write of a sample to its read: the mean, and the worst, since the connection was made. */
  latency_us?: number;
  latency_worst_us?: number;
}

/** Something that the robot needs and that is missing, faulty or given up. */
export interface Trouble {
  /** "robot", "host", "process", "task", "connection" (its reader), "pool". */
  kind: string;
  name: string;
  what: string;
  why: string;
  since: string;
  for_s: number;
  /** The repair that helps. */
  repair: string;
  /** The verb "repair" does. */
  on_request: boolean;
}

export interface Status {
  robot: string;
  controller: string;
  state: string;
  /** Absent where the robot runs an older Segue. */
  health?: { state: 'healthy' | 'in_transition' | 'in_trouble' | 'lost'; troubles: Trouble[] };
  /** Why this runtime commands the robot no longer: another one has got it. */
  lost?: string | null;
  commanded_by: string | null;
  /** The last halt, until something has been requested. */
  halt: Halt | null;
  /** The person who has stopped the robot until it is released. */
  stopped_by: string | null;
  controllers: string[];
  /** Of its components; absent where the robot runs an older Segue. */
  libraries?: string[];
  ready: { controller: string; ready: boolean; reason: string }[];
  tasks: Record<string, TaskStatus>;
  connections: Record<string, ConnectionStatus>;
  requests: OpenRequest[];
  differences: string[];
  uptime_s: number;
}

export interface Halt {
  who: string;
  why: string;
  time_s: number;
  /** "halting", "at_rest", "not_at_rest". */
  state: string;
  /** Tasks with devices that had to be stopped. */
  stopped?: string[];
  trouble?: string;
}

/** A request that has not ended. */
export interface OpenRequest {
  request: number;
  to: string;
  who: string;
  /** "waiting", "planning", "prepare", "commit", "retire" (past the point of commit), "undo". */
  state: string;
  cancelled_by: string | null;
}

export type Direction = 'input' | 'output';

export interface PortModel {
  name: string;
  direction: Direction;
  type: string;
  doc: string;
}

export interface OperationModel {
  name: string;
  arguments: { name: string; type: string; doc: string }[];
  result: string;
  doc: string;
}

export interface TaskReport extends TaskStatus {
  doc: string;
  ports: PortModel[];
  properties: { [name: string]: Json };
  operations: OperationModel[];
  timing: { [name: string]: number };
  /** Both are missing in reports of a process that runs an older Segue. */
  histograms?: { updates: Histogram; latencies: Histogram };
  log?: LogLine[];
}

export interface LogLine {
  number: number;
  time: string;
  /** "debug", "info", "warning", "error". */
  level: string;
  message: string;
}

/** Its bins go from the first one that has anything to the last one. */
export interface Histogram {
  p50_us: number;
  p99_us: number;
  bins: { from_us: number; below_us: number | null; count: number }[];
}

export interface RobotEvent {
  number: number;
  time: string;
  kind: string;
  subject: string;
  message: string;
  /** Absent where the robot runs an older Segue. */
  trouble?: boolean;
}

export interface Action {
  id: number;
  kind: string;
  phase?: string;
  after: number[];
  task?: string;
  operation?: string;
  from?: string;
  to?: string;
  process?: string;
  host?: string;
  /** Of a connection; `size` of a buffer. */
  policy?: string;
  size?: number;
  took_s?: number;
  duration_s?: number;
  outcome?: string;
  error?: string;
}

export interface Transition {
  from: string;
  to: string;
  actions: Action[];
  removes?: string[];
}

/** In seconds. */
export interface DurationRange {
  low: number;
  typical: number;
  high: number;
}

/** A transition that was only planned: the JSON of `segue switch --dry-run`. */
export interface PlannedTransition extends Transition {
  order?: string;
  /** By kinds of actions, and "state_changes" and "total". */
  counts?: { [kind: string]: number };
  /** Sentences; absent where the robot runs an older Segue. */
  changes?: string[];
  /** Absent where the robot has measured nothing yet. `actions`: typical seconds, in the order of the transition. */
  estimate_s?: Record<'total' | 'prepare' | 'commit' | 'retire', DurationRange> & { actions: number[]; critical_path: number[]; never_measured: number };
}

export interface SwitchOutcome extends Transition {
  outcome: string;
  duration_s: number;
  commit_s: number;
  error?: string;
  undo?: { restored: boolean; duration_s: number; actions: Action[] };
}

export function statusOf(value: Json | undefined): Status | null {
  return isMap(value) && isMap(value['tasks']) && isMap(value['connections']) ? (value as unknown as Status) : null;
}

/** "task.port" -> the task. Ids of tasks may have dots, names of ports not. */
export function taskOf(port: string): string {
  return port.slice(0, port.lastIndexOf('.'));
}
export function portOf(port: string): string {
  return port.slice(port.lastIndexOf('.') + 1);
}
