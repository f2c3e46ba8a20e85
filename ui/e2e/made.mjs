// SPDX-License-Identifier: Apache-2.0
// Made-up robots and missions of any size, as the page is told of them.

/** The same numbers at each start. */
function numbers(seed = 1) {
  return (below) => ((seed = (seed * 48271) % 2147483647), seed % below);
}

/**
 * Tasks in processes, and, with more than ten of these, in hosts of five; 70 % of the connections stay in a process, 20 % in a host.
 */
export function madeNetwork(taskCount, connectionCount, processCount) {
  const tasks = {};
  const connections = {};
  const perProcess = Math.ceil(taskCount / processCount);
  const perHost = processCount > 10 ? 5 : processCount;
  for (let i = 0; i < taskCount; ++i) {
    const process = Math.floor(i / perProcess);
    tasks['task_' + i] = {
      id: 'task_' + i, component: 'large::Task', state: 'running', state_name: 'running', host: 'host_' + Math.floor(process / perHost), process: 'process_' + process,
      pid: 100 + process, cycle_us: 1, worst_us: 1, cycles: 1, missed: 0, error: '',
    };
  }
  const random = numbers();
  for (let i = 0; i < connectionCount; ++i) {
    const source = random(taskCount);
    const near = random(10);
    const span = near < 7 ? perProcess : near < 9 ? perProcess * perHost : taskCount;
    const target = Math.min(taskCount - 1, Math.floor(source / span) * span + random(span));
    const [from, to] = ['task_' + source + '.out', 'task_' + target + '.in_' + i];
    connections[from + ' ' + to] = { from, to, policy: 'data', size: 1, written: 0, read: 0, dropped: 0 };
  }
  return {
    robot: 'large', controller: 'all', state: 'idle', commanded_by: null, controllers: ['all'], ready: [], tasks, connections, requests: [], halt: null, stopped_by: null, differences: [], uptime_s: 1,
  };
}

/** A mission of so many states, in containers of five; one in four goes back where it fails. It has begun its first state. */
export function madeMission(count) {
  const states = [{ path: '', title: 'made', kind: 'hierarchy', start: 'part_0', next: [] }];
  const parts = Math.ceil(count / 5);
  for (let part = 0; part < parts; ++part) {
    const path = 'part_' + part;
    const next = [part + 1 < parts ? { outcome: 'success', to: 'part_' + (part + 1) } : { outcome: 'success', returns: 'success' }];
    if (part > 1) next.push({ outcome: 'failed', to: 'part_' + (part - 2) });
    states.push({ path, title: path, kind: 'hierarchy', start: path + '/act_0', next });
    for (let i = 0; i < 4; ++i) {
      const after = i < 3 ? [{ outcome: 'success', to: path + '/act_' + (i + 1) }] : [{ outcome: 'success', returns: 'success' }, { outcome: 'too far', to: path + '/act_1' }];
      states.push({ path: path + '/act_' + i, in: path, title: 'act_' + i, kind: 'action', action: 'act', next: after });
    }
  }
  return {
    run: 1, mission: 'made', who: 'ann', state: 'running', dropped: 0, plan: { mission: 'made', states, complete: true, nodes: null },
    entries: { 1: { number: 1, time_s: 0, kind: 'began', action: 'part_0/act_0', iteration: 0 } }, control: null,
  };
}
