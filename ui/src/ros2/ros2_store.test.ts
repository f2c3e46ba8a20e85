// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';
import type { Json } from '../robot/change';
import { RobotError } from '../robot/connection';
import { Ros2Store } from './useRos2';

const places = [{ domain: 7, discovery: '' }, { domain: 3, discovery: 'localhost' }];
const answer = (place = places[0]) => ({ domain: 7, place, places, nodes: [], topics: [], tasks: {} }) as unknown as Json;

/** A studio that has these answers, in turn, and notes what it was asked for. */
function studioWith(...answers: (Json | Error)[]) {
  const asked: unknown[] = [];
  const call = (verb: string, args: { [key: string]: Json } = {}): Promise<Json> => {
    asked.push([verb, args]);
    const next = answers.shift() ?? null;
    return next instanceof Error ? Promise.reject(next) : Promise.resolve(next);
  };
  return { store: new Ros2Store({ call }), asked };
}

test('while a look is in progress no other one is asked for', async () => {
  const { store, asked } = studioWith(answer());
  const first = store.look();
  expect(store.get().isLooking).toBe(true);
  await store.look();
  await first;
  expect(asked).toEqual([['look_at_ros2', {}]]);
  expect(store.get()).toMatchObject({ isLooking: false, problem: '', seen: { domain: 7 } });
  expect(store.get().at).toBeGreaterThan(0);
});

test('a look that fails says why, and leaves the one before', async () => {
  const { store } = studioWith(answer(), new RobotError('unavailable', 'segue-ros2 is not installed'), null);
  await store.look();
  const { seen, at } = store.get();
  await store.look();
  expect(store.get()).toEqual({ seen, at, isLooking: false, problem: 'segue-ros2 is not installed' });
  await store.look();
  expect(store.get()).toMatchObject({ seen, problem: 'the studio has answered something else' });
});

test('a place that was chosen is looked at until the robot has no task there', async () => {
  const { store, asked } = studioWith(answer(), answer(places[1]), new RobotError('deadline-exceeded', 'late'), new RobotError('not-found', 'no task'), answer(), answer());
  await store.look();
  await store.look(places[1]);
  for (let looks = 0; looks < 3; ++looks) await store.look();
  await store.look(places[0]);
  const there = ['look_at_ros2', { domain: 3, discovery: 'localhost' }];
  const first = ['look_at_ros2', {}];
  expect(asked).toEqual([first, there, there, there, first, first]);
});

test('whoever listens is told', async () => {
  const { store } = studioWith(answer());
  const heard: boolean[] = [];
  const leave = store.subscribe(() => heard.push(store.get().isLooking));
  await store.look();
  leave();
  await store.look();
  expect(heard).toEqual([true, false]);
});
