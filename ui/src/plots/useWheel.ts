// SPDX-License-Identifier: Apache-2.0
import { useEffect, type RefObject } from 'react';
import { useLatest } from '../useLatest';

/** React's own listener for wheels is passive, so that it could not keep the page from scrolling. */
export function useWheel(canvas: RefObject<HTMLCanvasElement | null>, turn: (event: WheelEvent, place: HTMLCanvasElement) => void): void {
  const turnNow = useLatest(turn);
  useEffect(() => {
    const place = canvas.current;
    if (!place) return;
    const listen = (event: WheelEvent) => {
      event.preventDefault();
      turnNow.current(event, place);
    };
    place.addEventListener('wheel', listen, { passive: false });
    return () => place.removeEventListener('wheel', listen);
  }, [canvas, turnNow]);
}
