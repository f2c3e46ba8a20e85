// SPDX-License-Identifier: Apache-2.0
import { useReactFlow, useStore, type ReactFlowInstance } from '@xyflow/react';
import { useCallback, useEffect, useRef } from 'react';
import { useLatest } from '../useLatest';
import { fittingZoom, nodeHeight, nodeWidth, readable, type Layout, type Size } from './boxes';
import { fitted } from './view';

export interface Corner {
  x: number;
  y: number;
}

/** The upper left corner of a box in the graph; positions of boxes are relative to the boxes around them. */
export function cornerOf(id: string, boxes: Layout['boxes'], around: Map<string, string | undefined>): Corner | null {
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
  layout: Layout;
  /** The box around each box. */
  around: Map<string, string | undefined>;
  /** Moved into view whenever it changes. */
  target: string | null | undefined;
  /** Moved into view whenever it changes, unless it can be seen and read already. */
  follow: string | null | undefined;
  /** Stays in view where something opens beside the graph. */
  selected: string | null | undefined;
  /** The graph is read from it on. */
  first: string | undefined;
}

/** Moves a box into view where it cannot be seen or read; whether it has. */
function bringBox(flow: ReactFlowInstance, { layout: { boxes }, around }: Scene, { width, height }: Size, id: string | null | undefined): boolean {
  const box = boxes.get(id ?? '');
  const corner = box && id ? cornerOf(id, boxes, around) : null;
  if (!box || !corner) return false;
  const { x, y, zoom } = flow.getViewport();
  const size = { width: Math.min(box.width, nodeWidth), height: Math.min(box.height, nodeHeight) };
  const [left, top] = [corner.x * zoom + x, corner.y * zoom + y];
  const inside = left >= 0 && top >= 0 && left + size.width * zoom <= width && top + size.height * zoom <= height;
  if (inside && zoom > 0.99 * readable) return false;
  void flow.setCenter(corner.x + size.width / 2, corner.y + size.height / 2, { zoom: Math.max(zoom, readable), duration: 250 });
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
function useStill({ layout, around, target, follow }: Scene, fit: () => void, bring: () => void, memory: Memory): void {
  const flow = useReactFlow();
  useEffect(() => {
    const { boxes } = layout;
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
    else fit();
    // The target has an effect of its own, and what is followed too.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [layout, flow, fit, bring]);
}

/** Moves the target into view, once. */
function useTarget({ layout: { boxes }, around, target }: Scene, memory: Memory): void {
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

/** Shows the graph as far as it can be read, and brings what is followed, or else selected, into view. */
function useViews(now: { readonly current: { scene: Scene; pane: Size } }, memory: Memory) {
  const flow = useReactFlow();
  const bring = useCallback((alsoSelected = false) => {
    const { scene, pane } = now.current;
    const id = scene.layout.boxes.has(scene.follow ?? '') ? scene.follow : alsoSelected ? scene.selected : null;
    if (bringBox(flow, scene, pane, id) && id === scene.follow) memory.moved = true;
  }, [flow, now, memory]);
  const fit = useCallback(() => {
    const { scene: { layout, around, first }, pane } = now.current;
    if (layout.boxes.size === 0) return;
    const corner = (first !== undefined && cornerOf(first, layout.boxes, around)) || { x: 0, y: 0 };
    void flow.setViewport(fitted(layout.size, pane, corner)).then(() => bring(fittingZoom(layout.size, pane) < readable));
  }, [flow, now, bring]);
  return { bring, fit };
}

/** The visible part of a graph: all of it that can be read, until somebody moves it; it follows or jumps to targets. */
export function useCamera(scene: Scene) {
  const width = useStore((store) => store.width);
  const height = useStore((store) => store.height);
  const now = useLatest({ scene, pane: { width, height } });
  const memory = useRef<Memory>({ moved: false, toggled: null, reached: null }).current;
  const { bring, fit } = useViews(now, memory);
  useEffect(() => bring(), [scene.follow, bring]);
  useStill(scene, fit, bring, memory);
  // Where nobody has moved the graph, it stays in view, whatever opens beside it; of a large one what is selected does.
  useEffect(() => {
    const { layout, selected } = now.current.scene;
    const isLarge = fittingZoom(layout.size, { width, height }) < readable;
    if (memory.moved || (isLarge && selected)) bring(true);
    else fit();
  }, [width, height, fit, bring, memory, now]);
  useTarget(scene, memory);

  /** Something is opened or closed. */
  const toggles = useCallback((id: string) => {
    const corner = cornerOf(id, now.current.scene.layout.boxes, now.current.scene.around);
    memory.toggled = corner && { id, corner };
  }, [now, memory]);
  const onMove = useCallback((event: unknown) => {
    if (event) memory.moved = true; // by somebody; a click only begins and ends
  }, [memory]);
  return { toggles, onMove };
}
