// SPDX-License-Identifier: Apache-2.0
import { ViewportPortal } from '@xyflow/react';
import { useMemo } from 'react';
import type { GraphEdge } from './Graph';
import type { Layout } from './layout';
import { arrowOf, pathOf } from './route';

/** Many edges as one drawing for each look: hundreds of elements of their own would slow down each frame. */
export function BulkEdges({ edges, routes }: { edges: GraphEdge[]; routes: Layout['routes'] }) {
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
      </svg>
    </ViewportPortal>
  );
}
