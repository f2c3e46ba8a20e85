// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Shown } from '../robot/connection';
import { Keeper } from './keeper';
import type { Panel } from './layout';

/** Ports whose samples a test sends. */
class Ports {
  readonly looked = new Map<string, number>();
  private readonly documents = new Map<string, Shown>();
  private readonly listeners = new Set<() => void>();

  onChange = (listener: () => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };
  shown = (document: string) => this.documents.get(document);
  subscribe = (document: string) => {
    this.looked.set(document, (this.looked.get(document) ?? 0) + 1);
    return () => {
      this.looked.set(document, (this.looked.get(document) ?? 0) - 1);
      this.documents.delete(document);
    };
  };
  send(document: string, time: number, value: number) {
    if (!this.now().includes(document)) return;
    const version = (this.documents.get(document)?.version ?? 0) + 1;
    this.documents.set(document, { value: { time_s: time, period_s: 0.05, value }, version, skipped: 0 });
    this.listeners.forEach((listener) => listener());
  }
  now = () => [...this.looked].filter(([, count]) => count > 0).map(([document]) => document);
}

const panel = (id: number, task: string, kind: Panel['kind'] = 'time'): Panel => ({ id, kind, title: task, columns: 1, rows: 1, seconds: 30, sources: [{ task, port: 'out', path: [] }] });
const all = (keeper: Keeper, id: number) => keeper.of(id)?.recorder.between(0, 1e9, 0).data;

describe('the keeper of samples', () => {
  it('keeps those of plots over time, and asks for nothing else', () => {
    const ports = new Ports();
    const keeper = new Keeper(ports);
    keeper.keep([panel(1, 'a'), panel(2, 'b', 'image'), panel(3, 'c', 'profile')]);
    expect(ports.now()).toEqual(['port/a/out']);
    ports.send('port/a/out', 1, 5);
    ports.send('port/a/out', 2, 6);
    expect(all(keeper, 1)).toEqual([[1, 2], [5, 6]]);
    expect(keeper.of(2)).toBeUndefined();
  });

  it('goes on with a panel that is only moved, sized or named, and begins anew with other sources', () => {
    const ports = new Ports();
    const keeper = new Keeper(ports);
    keeper.keep([panel(1, 'a')]);
    ports.send('port/a/out', 1, 5);
    keeper.keep([panel(4, 'd'), { ...panel(1, 'a'), title: 'Speed', columns: 3, seconds: 600 }]);
    expect(all(keeper, 1)).toEqual([[1], [5]]);
    keeper.keep([panel(1, 'b')]);
    expect(all(keeper, 1)).toEqual([[]]);
    expect(ports.now()).toEqual(['port/b/out']);
    const kept = keeper.of(1);
    keeper.keep([]);
    kept?.pause(false); // by a panel that is on its way out
    expect(ports.now()).toEqual([]);
  });

  it('asks for nothing while paused, and interrupts the line', () => {
    const ports = new Ports();
    const keeper = new Keeper(ports);
    keeper.keep([panel(1, 'a')]);
    ports.send('port/a/out', 1, 5);
    keeper.of(1)?.pause(true);
    expect(ports.now()).toEqual([]);
    ports.send('port/a/out', 2, 6);
    keeper.of(1)?.pause(false);
    ports.send('port/a/out', 3, 7);
    expect(all(keeper, 1)?.[1]).toEqual([5, null, 7]);
  });

  it('tells of samples and of what is wrong with them', () => {
    const ports = new Ports();
    const keeper = new Keeper(ports);
    keeper.keep([panel(1, 'a')]);
    let told = 0;
    const stop = keeper.of(1)?.onChange(() => ++told);
    expect(keeper.of(1)?.state.waiting).toBe(true);
    ports.send('port/a/out', 1, 5);
    expect(keeper.of(1)?.state.waiting).toBe(false);
    expect(told).toBe(2);
    stop?.();
    ports.send('port/a/out', 2, 5);
    expect(told).toBe(2);
  });

  it('forgets the oldest samples of the largest panel where all have too much', () => {
    const ports = new Ports();
    const keeper = new Keeper(ports, 40);
    keeper.keep([panel(1, 'a'), panel(2, 'b')]);
    ports.send('port/b/out', 1, 0);
    for (let time = 1; time <= 100; ++time) {
      ports.send('port/a/out', time, time);
      expect(keeper.of(1)!.recorder.size + keeper.of(2)!.recorder.size).toBeLessThanOrEqual(40);
    }
    expect(all(keeper, 2)).toEqual([[1], [0]]);
    const times = [...(all(keeper, 1)?.[0] ?? [])];
    expect(times.pop()).toBe(100);
    expect(times.length).toBeGreaterThan(8);
  });
});
