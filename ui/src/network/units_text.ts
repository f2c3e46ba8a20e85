// SPDX-License-Identifier: Apache-2.0
import { livesOf, missionOf, planOf } from '../missions/mission';
import { isMap, type Json } from '../robot/change';

/** Who holds units of the robot, by their names: "2 by assemble: fetch/screw_in"; from the document "mission". */
export function holdersOf(document: Json | undefined): Map<string, string[]> {
  const holders = new Map<string, string[]>();
  const mission = missionOf(document);
  const plan = mission && mission.state !== 'ended' ? planOf(mission) : null;
  if (!mission || !plan) return holders;
  const lives = livesOf(mission);
  for (const { path, units } of plan.states) {
    if (lives.get(path) !== 'running') continue;
    for (const { name, count } of units ?? []) holders.set(name, [...(holders.get(name) ?? []), count + ' by ' + mission.mission + (path === '' ? '' : ': ' + path)]);
  }
  return holders;
}

/** "cups 3, screws 40 (held: 2 by assemble: screw_in)", from the document of units; '' where there are none. */
export function unitsText(document: Json | undefined, holders: ReadonlyMap<string, string[]>): string {
  const units = isMap(document) ? document['units'] : undefined;
  const heldText = (name: string) => (holders.has(name) ? ' (held: ' + holders.get(name)?.join(', ') + ')' : '');
  return Object.entries(isMap(units) ? units : {})
    .flatMap(([name, unit]) => (isMap(unit) ? [name + ' ' + String(unit['count']) + heldText(name)] : []))
    .sort()
    .join(', ');
}
