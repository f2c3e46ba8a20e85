// SPDX-License-Identifier: Apache-2.0
import { ViewportPortal } from '@xyflow/react';
import { useMemo } from 'react';
import type { GraphEdge } from './drawn_graph';
import type { Layout } from './layout';
import { arrowOf, labelPlace, pathOf } from './route';

/** About that of a character of a label, and what is left free around the label. */
const labelStep = 5.8;
const labelMargin = 2;
const labelHeight = 14;

function Labels({ edges, routes }: { edges: GraphEdge[]; routes: Layout['routes'] }) {
  const places = useMemo(() => new Map([...routes].map(([id, route]) => [id, labelPlace(route)])), [routes]);
  return edges.map(({ id, label }) => {
    const place = places.get(id);
    if (!label || !place) return null;
    const width = label.length * labelStep + 2 * labelMargin;
    return (
      <g key={id}>
        <rect x={place.x - width / 2} y={place.y - labelHeight / 2} width={width} height={labelHeight} />
        <text x={place.x} y={place.y}>{label}</text>
      </g>
    );
  });
}

/**
 * Many edges as one drawing, and one path of it for each look: dozens of elements of their own, each a layer of its own while the
 * graph moves, would slow down each frame.
 */
export function BulkEdges({ edges, routes, labelled }: { edges: GraphEdge[]; routes: Layout['routes']; labelled: boolean }) {
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
        {labelled && <Labels edges={edges} routes={routes} />}
      </svg>
    </ViewportPortal>
  );
}
