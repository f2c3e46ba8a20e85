// SPDX-License-Identifier: Apache-2.0
import { useEffect, useSyncExternalStore } from 'react';
import { reason } from '../reason';
import type { Json } from '../robot/change';
import { RobotError, type Connection } from '../robot/connection';
import { useConnection, useLink } from '../robot/hooks';
import { seenIn, type Place, type Ros2Seen } from './ros2';

/** The looks at ROS 2 of this page, which stay while other views are shown. */
export interface Ros2State {
  /** The last look that went well. */
  seen: Ros2Seen | null;
  /** When that was (milliseconds since 1970). */
  at: number;
  isLooking: boolean;
  /** Why the last look failed; '': it did not. */
  problem: string;
}

export class Ros2Store {
  private state: Ros2State = { seen: null, at: 0, isLooking: false, problem: '' };
  private place: Place | null = null;
  private readonly listeners = new Set<() => void>();

  constructor(private readonly connection: Pick<Connection, 'call'>) {}

  subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };
  get = (): Ros2State => this.state;

  /** Looks again, from now on at `place` where one is given; does nothing while a look is in progress. */
  async look(place?: Place): Promise<void> {
    if (this.state.isLooking) return;
    if (place) this.place = place;
    this.set({ isLooking: true });
    try {
      const seen = seenIn(await this.connection.call('look_at_ros2', this.arguments()));
      this.set(seen ? { seen, at: Date.now(), problem: '', isLooking: false } : { problem: 'the studio has answered something else', isLooking: false });
    } catch (error) {
      if (error instanceof RobotError && error.code === 'not-found') this.place = null; // the robot has no task there any more
      this.set({ problem: reason(error), isLooking: false });
    }
  }

  /** None for the first of the robot's places, so that all pages ask for the same. */
  private arguments(): { [key: string]: Json } {
    const first = this.state.seen?.places[0];
    const { place } = this;
    return place === null || (place.domain === first?.domain && place.discovery === first.discovery) ? {} : { domain: place.domain, discovery: place.discovery };
  }
  private set(change: Partial<Ros2State>): void {
    this.state = { ...this.state, ...change };
    for (const listener of this.listeners) listener();
  }
}

const all = new WeakMap<Connection, Ros2Store>();

/** The last look; the first one is made when somebody wants to see it. */
export function useRos2(): Ros2State & { look: (place?: Place) => void } {
  const connection = useConnection();
  const link = useLink();
  let store = all.get(connection);
  if (!store) all.set(connection, (store = new Ros2Store(connection)));
  const kept = store;
  const state = useSyncExternalStore(kept.subscribe, kept.get);
  const isNew = state.seen === null && state.problem === '';
  useEffect(() => {
    if (isNew && link === 'open') void kept.look();
  }, [kept, isNew, link]);
  return { ...state, look: (place) => void kept.look(place) };
}
