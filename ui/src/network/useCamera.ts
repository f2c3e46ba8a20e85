// SPDX-License-Identifier: Apache-2.0
import { useReactFlow, useStore, type ReactFlowInstance } from '@xyflow/react';
import { useCallback, useEffect, useRef } from 'react';
import { useLatest } from '../useLatest';
import { nodeHeight, nodeWidth, type Box } from './layout';

const fitting = { padding: 0.08, maxZoom: 1.15 };
const readable = 0.7;
/** The zoom at which a target that is followed is large enough. */
const legible = 0.45;

export interface Corner {
  x: number;
  y: number;
}

/** The upper left corner of a box in the graph; positions of boxes are relative to the boxes around them. */
export function cornerOf(id: string, boxes: Map<string, Box>, around: Map<string, string | undefined>): Corner | null {
  let corner: Corner = { x: 0, y: 0 };
  for (let at: string | undefined = id; at !== undefined; at = around.get(at)) {
    const box = boxes.get(at);
    if (!box) return null;
    corner = { x: corner.x + box.x, y: corner.y + box.y };
  }
  return corner;
}

/** The boxes of the graph. */
interface Scene {
  boxes: Map<string, Box>;
  /** The box around each box. */
  around: Map<string, string | undefined>;
  /** Moved into view whenever it changes. */
  target: string | null | undefined;
  /** Moved into view whenever it changes, unless it can be seen and read already. */
  follow: string | null | undefined;
}

/** Moves what is followed into view where it cannot be seen or read; whether it has. */
function bringFollowed(flow: ReactFlowInstance, { boxes, around, follow }: Scene, width: number, height: number): boolean {
  const box = boxes.get(follow ?? '');
  const corner = box && follow ? cornerOf(follow, boxes, around) : null;
  if (!box || !corner) return false;
  const { x, y, zoom } = flow.getViewport();
  const size = { width: Math.min(box.width, nodeWidth), height: Math.min(box.height, nodeHeight) };
  const [left, top] = [corner.x * zoom + x, corner.y * zoom + y];
  const inside = left >= 0 && top >= 0 && left + size.width * zoom <= width && top + size.height * zoom <= height;
  if (inside && zoom >= legible) return false;
  void flow.setCenter(corner.x + size.width / 2, corner.y + size.height / 2, { zoom: Math.max(zoom, legible), duration: 250 });
  return true;
}

/** The camera's memory from one drawing to the next. */
interface Memory {
  /** The view was moved, by somebody or to something. */
  moved: boolean;
  /** The box that was opened or closed, and its corner before. */
  toggled: { id: string; corner: Corner } | null;
  /** The last target that was moved into view. */
  reached: string | null;
}

/** After a new layout what somebody opened or closed stays where it was; else all of the graph is shown. */
function useStill({ boxes, around, target, follow }: Scene, bring: () => void, memory: Memory): void {
  const flow = useReactFlow();
  useEffect(() => {
    const before = memory.toggled;
    memory.toggled = null;
    const corner = before && memory.moved ? cornerOf(before.id, boxes, around) : null;
    if (before && corner) {
      const { x, y, zoom } = flow.getViewport();
      void flow.setViewport({ x: x + (before.corner.x - corner.x) * zoom, y: y + (before.corner.y - corner.y) * zoom, zoom });
      return;
    }
    if (target && memory.reached !== target) return;
    if (memory.moved && boxes.has(follow ?? '')) bring();
    else void flow.fitView(fitting).then(bring);
    // The target has an effect of its own, and what is followed too.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [boxes, flow, bring]);
}

/** Moves the target into view, once. */
function useTarget({ boxes, around, target }: Scene, memory: Memory): void {
  const flow = useReactFlow();
  useEffect(() => {
    if (!target) memory.reached = null;
    if (!target || memory.reached === target) return;
    const corner = cornerOf(target, boxes, around);
    if (!corner) return;
    memory.reached = target;
    memory.moved = true;
    const box = boxes.get(target);
    const zoom = Math.max(flow.getZoom(), readable);
    void flow.setCenter(corner.x + (box?.width ?? 0) / 2, corner.y + (box?.height ?? 0) / 2, { zoom, duration: 250 });
    // `around` changes with the boxes.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [target, boxes, flow, memory]);
}

/** The visible part of a graph: all of it until somebody moves it; it follows or jumps to targets. */
export function useCamera(scene: Scene) {
  const flow = useReactFlow();
  const width = useStore((store) => store.width);
  const height = useStore((store) => store.height);
  const now = useLatest({ scene, width, height });
  const memory = useRef<Memory>({ moved: false, toggled: null, reached: null }).current;
  const bring = useCallback(() => {
    if (bringFollowed(flow, now.current.scene, now.current.width, now.current.height)) memory.moved = true;
  }, [flow, now, memory]);
  useEffect(bring, [scene.follow, bring]);
  useStill(scene, bring, memory);
  // Where nobody has moved the graph, all of it stays in view, whatever opens beside it.
  useEffect(() => {
    if (memory.moved) bring();
    else void flow.fitView(fitting).then(bring);
  }, [width, height, flow, bring, memory]);
  useTarget(scene, memory);

  /** Something is opened or closed. */
  const toggles = useCallback((id: string) => {
    const corner = cornerOf(id, now.current.scene.boxes, now.current.scene.around);
    memory.toggled = corner && { id, corner };
  }, [now, memory]);
  const onMove = useCallback((event: unknown) => {
    if (event) memory.moved = true; // by somebody; a click only begins and ends
  }, [memory]);
  return { toggles, onMove };
}
