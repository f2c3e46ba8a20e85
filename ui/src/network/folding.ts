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

/** The next level at which something else is folded, of what does not stay as it is; null: there is none. */
export function levelBehind(levels: FoldLevels, at: number, stays: (place: string) => boolean): number | null {
  const now = levels[at] ?? new Set();
  const found = levels.findIndex((level, index) => index > at && [...level].some((place) => !now.has(place) && !stays(place)));
  return found < 0 ? null : found;
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
  /** Folds more, but not what is `around` a selection, as long as nobody has decided otherwise; whether it does. */
  const onCrowded = (around: string[] = []) => {
    const stays = new Map([...around.map((place): [string, boolean] => [place, isFolded(place)]), ...toggled]);
    const at = levelBehind(levels, level.at, (place) => stays.has(place));
    if (level.isTouched || at === null) return false;
    setToggled(stays);
    setKept({ ...level, at });
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
