// SPDX-License-Identifier: Apache-2.0
import { ViewportPortal } from '@xyflow/react';
import { useMemo } from 'react';
import { labelWidth, type GraphEdge } from './drawn_graph';
import type { Layout } from './boxes';
import { labelBox } from './labels';
import { arrowOf, pathOf } from './route';

function Labels({ edges, labels }: { edges: GraphEdge[]; labels: Layout['labels'] }) {
  return edges.map(({ id, label }) => {
    const place = labels.get(id);
    if (!label || !place) return null;
    const { x, y, width, height } = labelBox(place, labelWidth(label));
    return (
      <g key={id}>
        <rect x={x} y={y} width={width} height={height} />
        <text x={place.x} y={place.y}>{label}</text>
      </g>
    );
  });
}

/**
 * Many edges as one drawing, and one path of it for each look: dozens of elements of their own, each a layer of its own while the
 * graph moves, would slow down each frame.
 */
export function BulkEdges({ edges, routes, labels }: { edges: GraphEdge[]; routes: Layout['routes']; labels: Layout['labels'] | null }) {
  const looks = edges.map((edge) => edge.look).join('\n'); // edges are new objects with each value
  const paths = useMemo(() => {
    const found = new Map<string, { lines: string[]; arrows: string[] }>();
    for (const edge of edges) {
      const route = routes.get(edge.id);
      if (!route) continue;
      const path = found.get(edge.look) ?? { lines: [], arrows: [] };
      found.set(edge.look, path);
      path.lines.push(pathOf(route));
      path.arrows.push(arrowOf(route));
    }
    return [...found].map(([look, { lines, arrows }]) => ({ look, lines: lines.join(' '), arrows: arrows.join(' ') }));
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [looks, routes]);
  return (
    <ViewportPortal>
      <svg className="bulk-edges" aria-hidden="true">
        {paths.map(({ look, lines, arrows }) => (
          <g key={look} className={'edge ' + look}>
            <path d={lines} />
            <path className="arrows" d={arrows} />
          </g>
        ))}
        {labels && <Labels edges={edges} labels={labels} />}
      </svg>
    </ViewportPortal>
  );
}
