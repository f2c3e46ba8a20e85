// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState, type KeyboardEvent, type PointerEvent } from 'react';
import { Footer } from './Footer';
import { sourceText, type Panel } from './layout';
import { poseText, type Point } from './map';
import { MapView } from './map_view';
import { useDark, useFrame, useSamples, useSize } from './useSamples';
import { useWheel } from './useWheel';

/** The map of a panel on its canvas; the poses that it shows as words. */
function useMap(panel: Panel, paused: boolean) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const words = useRef<HTMLParagraphElement>(null);
  const [map] = useState(() => new MapView(panel));
  map.panel = panel;
  const [follow, setFollow] = useState(false);
  const dark = useDark();
  const draw = useFrame(() => {
    const poses = canvas.current && map.draw(canvas.current, dark, follow);
    if (poses && words.current) words.current.textContent = poses.map(poseText).join('; ');
  });
  const state = useSamples(panel.sources, paused, (document, time, sample) => [map.take(document, time, sample), draw()]);
  const sources = JSON.stringify(panel.sources);
  useEffect(() => {
    map.reset();
    draw();
  }, [map, sources, draw]);
  useEffect(draw, [draw, dark, follow]);
  useSize(canvas, draw);
  return { canvas, words, map, draw, follow, setFollow, state };
}

function useDrag(pan: (x: number, y: number) => void) {
  const drag = useRef<Point | null>(null);
  const end = () => {
    drag.current = null;
  };
  return {
    onPointerDown: (event: PointerEvent) => {
      event.currentTarget.setPointerCapture(event.pointerId);
      drag.current = { x: event.clientX, y: event.clientY };
    },
    onPointerMove: (event: PointerEvent) => {
      if (!drag.current) return;
      pan(drag.current.x - event.clientX, event.clientY - drag.current.y);
      drag.current = { x: event.clientX, y: event.clientY };
    },
    onPointerUp: end,
    onPointerCancel: end,
  };
}

export function MapPanel({ panel, paused }: { panel: Panel; paused: boolean }) {
  const { canvas, words, map, draw, follow, setFollow, state } = useMap(panel, paused);
  const zoom = (factor: number) => [map.zoom(factor), draw()];
  const pan = (x: number, y: number) => [setFollow(false), map.pan(x, y), draw()];
  const showAll = () => canvas.current && [map.showAll(canvas.current), setFollow(false), draw()];
  const drag = useDrag(pan);
  useWheel(canvas, (event, place) => [map.zoomAt(Math.exp(-event.deltaY * 0.0015), place, { x: event.offsetX, y: event.offsetY }), draw()]);
  const press = (event: KeyboardEvent) => {
    if (event.key === 'ArrowLeft') pan(-40, 0);
    else if (event.key === 'ArrowRight') pan(40, 0);
    else if (event.key === 'ArrowUp') pan(0, 40);
    else if (event.key === 'ArrowDown') pan(0, -40);
    else if (event.key === '+') zoom(1.5);
    else if (event.key === '-') zoom(1 / 1.5);
    else return;
    event.preventDefault();
  };
  return (
    <>
      <div className="panel-tools">
        <button type="button" className="small" aria-label="Zoom in" onClick={() => zoom(1.5)}>+</button>
        <button type="button" className="small" aria-label="Zoom out" onClick={() => zoom(1 / 1.5)}>−</button>
        <button type="button" className="small" onClick={showAll}>All</button>
        <label><input type="checkbox" checked={follow} onChange={(event) => [map.hold(), setFollow(event.target.checked)]} /> follow</label>
        <p className="quiet" ref={words} />
      </div>
      <canvas
        ref={canvas} className="map" role="img" tabIndex={0} {...drag} onKeyDown={press}
        aria-label={'Map of ' + panel.sources.map(sourceText).join(', ') + '; arrow keys move it, plus and minus zoom'}
      />
      <Footer state={state} paused={paused} />
    </>
  );
}
