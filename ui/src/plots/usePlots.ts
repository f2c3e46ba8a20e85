// SPDX-License-Identifier: Apache-2.0
import { createContext, useContext, useEffect, useState, useSyncExternalStore } from 'react';
import { reason } from '../reason';
import { useConnection } from '../robot/hooks';
import { useLatest } from '../useLatest';
import { Keeper, type Kept } from './keeper';
import { mostPorts, parseLayout, portsOf, type Panel } from './layout';
import { noSamples } from './samples';
import { keepLayout, storedLayout } from './stored';

const longestFile = 1 << 20;

interface Note {
  text: string;
  bad: boolean;
  /** The panels that a loaded layout has replaced. */
  before?: Panel[];
}

/** The panels that this browser keeps for the robot ('': not known yet), what is told of their last change, and their samples. */
export function usePlotsOf(robot: string) {
  const connection = useConnection();
  const [keeper] = useState(() => new Keeper(connection));
  const [panels, setPanels] = useState<Panel[]>([]);
  const [note, setNote] = useState<Note | null>(null);
  useEffect(() => {
    if (robot === '') return undefined;
    const first = storedLayout(robot);
    keeper.keep(first.panels);
    setPanels(first.panels);
    if (first.problem) setNote({ text: first.problem, bad: true });
    return () => keeper.keep([]);
  }, [robot, keeper]);
  const keep = (next: Panel[], told: Note | null = null) => {
    const ports = portsOf(next).size;
    if (ports > mostPorts) return setNote({ text: 'That would show ' + ports + ' ports; ' + mostPorts + ' are the most.', bad: true });
    keeper.keep(next);
    setPanels(next);
    const problem = keepLayout(robot, next);
    setNote(problem ? { text: problem, bad: true } : told);
  };
  const load = async (chosen: File) => {
    try {
      if (chosen.size > longestFile) throw new Error('it is larger than 1 MiB');
      const next = parseLayout(await chosen.text());
      keep(next, { text: 'Loaded ' + chosen.name + '.', bad: false, before: panels });
    } catch (error) {
      setNote({ text: chosen.name + ' was not loaded: ' + reason(error), bad: true });
    }
  };
  const move = (from: number, to: number) => {
    const next = [...panels];
    const [panel] = next.splice(from, 1);
    if (!panel || to < 0 || to > next.length) return;
    next.splice(to, 0, panel);
    keep(next);
  };
  const change = (changed: Panel) => keep(panels.map((one) => (one.id === changed.id ? changed : one)));
  const remove = (panel: Panel) => keep(panels.filter((one) => one.id !== panel.id), { text: 'Removed ' + panel.title + '.', bad: false, before: panels });
  return { keeper, panels, note, keep, load, move, change, remove };
}
export type Plots = ReturnType<typeof usePlotsOf>;

/** The plots of the page, which live as long as it does. */
export const PlotsContext = createContext<Plots | null>(null);

export function usePlots(): Plots {
  const plots = useContext(PlotsContext);
  if (!plots) throw new Error('there are no plots around this component');
  return plots;
}

/** The kept samples of a panel, which may be paused as long as it is shown; calls `onSample` for each. Null for no panel. */
export function useKept(panel: Panel | null, paused: boolean, onSample: () => void): Kept | null {
  const { keeper } = usePlots();
  const kept = (panel && keeper.of(panel.id)) ?? null;
  const newest = useLatest(onSample);
  useEffect(() => kept?.onChange(() => newest.current()), [kept, newest]);
  useEffect(() => {
    kept?.pause(paused);
    return () => kept?.pause(false);
  }, [kept, paused]);
  useSyncExternalStore(kept?.onChange ?? never, () => kept?.state ?? noSamples);
  return kept;
}
const never = () => () => {};
