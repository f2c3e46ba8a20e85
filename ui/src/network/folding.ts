// SPDX-License-Identifier: Apache-2.0
import { useMemo, useState } from 'react';

/** Which boxes are folded unless somebody has decided: from one level to the next more of them. */
export type FoldLevels = ReadonlySet<string>[];

interface Level {
  /** The structure that it is for. */
  of: unknown;
  at: number;
  /** Somebody has opened or closed something since, so that nothing folds by itself. */
  isTouched: boolean;
}

/**
 * Which boxes are folded: those that somebody has closed and, so that the others can be read, those of the first level at
 * which the graph fits. A new `structure` begins with the first level anew.
 */
export function useFolding(structure: unknown, levels: FoldLevels) {
  const [toggled, setToggled] = useState<ReadonlyMap<string, boolean>>(new Map());
  const [kept, setKept] = useState<Level>({ of: null, at: 0, isTouched: false });
  const level = kept.of === structure ? kept : { of: structure, at: 0, isTouched: false };
  const folded = levels[level.at];
  const isFolded = useMemo(() => (place: string) => toggled.get(place) ?? folded?.has(place) ?? false, [toggled, folded]);
  const set = (isToBeFolded: boolean, places: string[]) => {
    setToggled(new Map([...toggled, ...places.map((place): [string, boolean] => [place, isToBeFolded])]));
    setKept({ ...level, isTouched: true });
  };
  /** Folds more, as long as nobody has decided otherwise; whether it does. */
  const onCrowded = () => {
    if (level.isTouched || level.at + 1 >= levels.length) return false;
    setKept({ ...level, at: level.at + 1 });
    return true;
  };
  return { isFolded, set, toggle: (place: string) => set(!isFolded(place), [place]), onCrowded };
}

/** About as many boxes can be read side by side. */
const mostSeen = 16;
/** Where fewer boxes would be left nothing folds by itself: that tells too little, and the graph can be moved. */
export const fewestSeen = 5;

/** Levels for `groups`, with their sizes: all open, the large ones folded, all inner ones folded, all folded. */
export function foldLevels(groups: { id: string; size: number; isInner: boolean }[], isLarge: boolean): FoldLevels {
  const inner = groups.filter((group) => group.isInner).sort((a, b) => a.size - b.size);
  const outer = groups.filter((group) => !group.isInner);
  let shown = inner.length;
  const large = inner.filter((group) => (shown += group.size) > mostSeen);
  const folded = [...(inner.length >= fewestSeen ? [large, inner] : []), ...(outer.length >= fewestSeen || isLarge ? [groups] : [])];
  const all = [[], ...folded].map((those) => new Set(those.map((group) => group.id)));
  const different = all.filter((level, index) => index === 0 || level.size > (all[index - 1]?.size ?? 0));
  return isLarge ? different.slice(-1) : different;
}
