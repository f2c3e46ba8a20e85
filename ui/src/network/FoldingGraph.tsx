// SPDX-License-Identifier: Apache-2.0
import { useMemo } from 'react';
import type { GraphEdge, GraphGroup, GraphNode } from './drawn_graph';
import { foldGroups } from './fold_groups';
import { fewestSeen, useFolding } from './folding';
import { Graph } from './Graph';

interface Props {
  label: string;
  groups: GraphGroup[];
  nodes: GraphNode[];
  edges: GraphEdge[];
  /** The look of what does not matter: groups with nothing else fold first. */
  quiet: string;
  /** The look of several things with different looks. */
  mixed: string;
}

/** A graph whose groups fold where it would be too large to be read; a click opens and closes them. */
export function FoldingGraph({ label, groups, nodes, edges, quiet, mixed }: Props) {
  const structure = JSON.stringify([groups.map((group) => group.id), nodes.map((node) => node.id)]);
  const levels = useMemo(() => {
    const lively = new Set(nodes.filter((node) => node.look !== quiet).map((node) => node.group));
    const folded = [groups.filter((group) => !lively.has(group.id)), groups].map((those) => new Set(those.map((group) => group.id)));
    const seen = (level: Set<string>) => level.size + nodes.filter((node) => !level.has(node.group ?? '')).length;
    return [new Set<string>(), ...folded.filter((level) => level.size > 0 && seen(level) >= fewestSeen)];
    // Looks change while a film plays, which folds nothing.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [structure]);
  const { isFolded, toggle, onCrowded } = useFolding(structure, levels);
  const shown = useMemo(() => foldGroups({ groups, nodes, edges }, isFolded, mixed), [groups, nodes, edges, isFolded, mixed]);
  return <Graph label={label} {...shown} onToggle={toggle} onCrowded={onCrowded} />;
}
