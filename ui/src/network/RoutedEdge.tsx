// SPDX-License-Identifier: Apache-2.0
import { BaseEdge, getBezierPath, type Edge, type EdgeProps } from '@xyflow/react';
import { pathOf, type Point } from './route';

export type RoutedEdgeData = Edge<{ route?: Point[]; labelAt?: Point }, 'routed'>;

/** An edge along the points that were laid out for it; a plain curve where there are none (yet). */
export function RoutedEdge(props: EdgeProps<RoutedEdgeData>) {
  const route = props.data?.route;
  const [curve, curveX, curveY] = route ? ['', 0, 0] : getBezierPath(props);
  const middle = props.data?.labelAt ?? { x: curveX, y: curveY };
  return (
    <BaseEdge
      path={route ? pathOf(route) : curve} markerEnd={props.markerEnd} interactionWidth={props.interactionWidth} label={props.label} labelBgPadding={[4, 1]} labelX={middle.x} labelY={middle.y}
    />
  );
}

export const edgeTypes = { routed: RoutedEdge };
