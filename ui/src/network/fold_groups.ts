// SPDX-License-Identifier: Apache-2.0
import { labelWidth, type GraphEdge, type GraphGroup, type GraphNode } from './drawn_graph';

interface Picture {
  groups: GraphGroup[];
  nodes: GraphNode[];
  edges: GraphEdge[];
}

const lookOf = (those: { look: string }[], mixed: string): string => {
  const first = those[0]?.look ?? '';
  return those.every((one) => one.look === first) ? first : mixed;
};

/** "3 added, 2 unchanged" */
function countsOf(nodes: GraphNode[]): string {
  const counts = new Map<string, number>();
  for (const node of nodes) counts.set(node.detail, (counts.get(node.detail) ?? 0) + 1);
  return [...counts].sort(([, a], [, b]) => a - b).map(([detail, count]) => count + ' ' + detail).join(', ');
}

function foldedEdges(edges: GraphEdge[], shownFor: (node: string) => string, mixed: string): GraphEdge[] {
  const bundles = new Map<string, GraphEdge[]>();
  for (const edge of edges) {
    const [source, target] = [shownFor(edge.source), shownFor(edge.target)];
    if (source === target && source !== edge.source) continue;
    const id = source + ' -> ' + target;
    bundles.set(id, [...(bundles.get(id) ?? []), { ...edge, source, target }]);
  }
  return [...bundles].map(([id, those]) => {
    const [first] = those as [GraphEdge];
    const label = those.length > 1 ? '×' + those.length : first.label;
    return { ...first, id, label, room: label === undefined ? undefined : labelWidth(label), look: lookOf(those, mixed) };
  });
}

/** The picture with one box for each folded group, which says how many of what are in it. */
export function foldGroups({ groups, nodes, edges }: Picture, isFolded: (group: string) => boolean, mixed: string): Picture {
  const groupOf = new Map(nodes.map((node) => [node.id, node.group]));
  const shownFor = (node: string) => {
    const group = groupOf.get(node);
    return group !== undefined && isFolded(group) ? group : node;
  };
  const folded = groups.filter((group) => isFolded(group.id)).map((group): GraphNode => {
    const inside = nodes.filter((node) => node.group === group.id);
    return { id: group.id, title: '▸ ' + group.title, detail: countsOf(inside), look: lookOf(inside, mixed), folded: true, isWide: true };
  });
  return {
    groups: groups.filter((group) => !isFolded(group.id)).map((group) => ({ ...group, title: '▾ ' + group.title })),
    nodes: [...folded, ...nodes.filter((node) => shownFor(node.id) === node.id)],
    edges: foldedEdges(edges, shownFor, mixed),
  };
}
