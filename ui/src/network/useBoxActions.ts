// SPDX-License-Identifier: Apache-2.0
import { useReactFlow, type Node } from '@xyflow/react';
import { useCallback, useMemo, useRef, type FocusEvent, type KeyboardEvent } from 'react';
import { useLatest } from '../useLatest';
import type { BoxActions } from './BoxButtons';
import type { Buttons } from './GraphBoxes';

interface Asked {
  onSelect?: (id: string | null) => void;
  onToggle?: (id: string) => void;
  onMark?: (id: string) => void;
  markKey?: string;
  onPeek?: (id: string | null) => void;
}

const isFolded = (node: Node) => node.data['expanded'] === undefined && (node.type !== 'task' || node.data['folded'] === true);

/** The handlers of clicks and buttons. They stay the same functions as long as the graph is shown: others would draw each task anew. */
function useClicks(asked: { readonly current: Asked }, toggles: (id: string) => void) {
  const act = useCallback(
    (id: string, isToggle: boolean) => {
      if (!isToggle) return asked.current.onSelect?.(id);
      toggles(id);
      asked.current.onToggle?.(id);
    },
    [asked, toggles],
  );
  const click = useCallback((_: unknown, node: Node) => act(node.id, isFolded(node)), [act]);
  const buttons = useMemo<BoxActions>(() => ({ toggle: (id) => act(id, true), mark: (id) => asked.current.onMark?.(id) }), [act, asked]);
  const leave = useCallback(() => asked.current.onSelect?.(null), [asked]);
  return { act, click, buttons, leave };
}

/** Where the pointer or the focus of the keyboard is; `reachedByKey`: the box that has that focus. */
function usePeeks(asked: { readonly current: Asked }) {
  // A box that was clicked on has the focus, too, but another one may be selected since.
  const reachedByKey = useRef<string | null>(null);
  const enter = useCallback((_: unknown, node: Node) => asked.current.onPeek?.(node.id), [asked]);
  const leaveNode = useCallback(() => asked.current.onPeek?.(null), [asked]);
  const focus = useCallback((event: FocusEvent) => {
    const id = (event.target as HTMLElement).dataset['id'];
    reachedByKey.current = id !== undefined && event.target.matches(':focus-visible') ? id : null;
    if (reachedByKey.current !== null) asked.current.onPeek?.(reachedByKey.current);
  }, [asked]);
  return { reachedByKey, enter, leaveNode, focus };
}

/** The handlers of pointer and keyboard at boxes; `toggles` is told before a box is opened or closed. */
export function useBoxActions(props: Asked, toggles: (id: string) => void) {
  const flow = useReactFlow();
  const asked = useLatest(props);
  const { act, click, buttons, leave } = useClicks(asked, toggles);
  const { reachedByKey, enter, leaveNode, focus } = usePeeks(asked);
  const press = useCallback(
    (event: KeyboardEvent) => {
      const node = flow.getNode((event.target as HTMLElement).dataset['id'] ?? '');
      if (!node || event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
      const { expanded, mark } = node.data as Buttons;
      if (event.key === 'Enter') click(event, node);
      if ((event.key === 'ArrowRight' && expanded === false) || (event.key === 'ArrowLeft' && expanded === true)) act(node.id, true);
      if (event.key !== asked.current.markKey || !mark || mark.fixed || reachedByKey.current !== node.id) return;
      event.stopPropagation(); // elsewhere the key may mean the selected box
      asked.current.onMark?.(node.id);
    },
    [act, click, flow, asked, reachedByKey],
  );
  return { buttons, click, leave, press, enter, leaveNode, focus };
}
