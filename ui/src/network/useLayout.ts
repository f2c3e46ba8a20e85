// SPDX-License-Identifier: Apache-2.0
import { useStore } from '@xyflow/react';
import { useEffect, useRef, useState } from 'react';
import { fittingZoom, noLayout, readable, type Layout, type LayoutInput, type Size } from './boxes';
import { Layouter } from './layout';

/** Panes that differ less have one layout. */
const sameShape = 0.08;
/** How long, in ms, a pane has had its size before the graph is laid out for it. */
const restsFor = 150;

/** The pane that a layout is for, and the window around it. */
interface Shape {
  pane: Size;
  window: Size;
}

const differs = (now: Size, before: Size) => [now.width / before.width, now.height / before.height].some((ratio) => Math.abs(ratio - 1) > sameShape);

/** The size of the pane when it has come to rest, and whether it is that of now. While the graph `isHeld`, only another size of the window counts. */
function useShape(isHeld: boolean): { shape: Size | undefined; isCurrent: boolean } {
  const width = useStore((store) => store.width);
  const height = useStore((store) => store.height);
  const [shape, setShape] = useState<Shape>();
  const now: Shape = { pane: { width, height }, window: { width: window.innerWidth, height: window.innerHeight } };
  const part = isHeld ? 'window' : 'pane';
  const isCurrent = shape !== undefined && !differs(now[part], shape[part]);
  useEffect(() => {
    if (width === 0 || height === 0 || isCurrent) return undefined;
    const timer = setTimeout(() => setShape(now), shape ? restsFor : 0);
    return () => clearTimeout(timer);
    // `now` has the size and the window of this effect.
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [width, height, shape, isCurrent]);
  return { shape: shape?.pane, isCurrent };
}

export interface Laying {
  /** Changes where the graph is to be laid out anew; values do not move anything. */
  structure: string;
  input: () => LayoutInput;
  /** Something is selected, so that nothing may move because a panel opens beside the graph. */
  isHeld: boolean;
  /** Not all can be shown so that it can be read; whether something is folded now, so that this layout is not shown. */
  onCrowded?: () => boolean;
}

/** Where boxes and edges are; `isBusy`: they are laid out anew, and will move. */
export function useLayout({ structure, input, isHeld, onCrowded }: Laying): { layout: Layout; isBusy: boolean } {
  const [layout, setLayout] = useState<Layout>(noLayout);
  const [answered, setAnswered] = useState<{ structure: string; shape: Size }>();
  const layouter = useRef(new Layouter());
  const { shape, isCurrent } = useShape(isHeld);
  useEffect(() => {
    if (!shape) return undefined;
    let current = true;
    layouter.current.ask({ ...input(), shape }, (found) => {
      if (!current) return;
      setAnswered({ structure, shape });
      if (fittingZoom(found.size, shape) >= readable || !onCrowded?.()) setLayout(found);
    });
    return () => {
      current = false;
    };
    // eslint-disable-next-line react-hooks/exhaustive-deps
  }, [structure, shape]);
  return { layout, isBusy: !isCurrent || answered?.structure !== structure || answered.shape !== shape };
}
