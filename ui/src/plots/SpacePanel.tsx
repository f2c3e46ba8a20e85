// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState, type KeyboardEvent, type PointerEvent } from 'react';
import { Footer } from './Footer';
import { sourceText, type Panel } from './layout';
import { poseText } from './map';
import { moved, nearer, turned, type Orbit } from './orbit';
import { SpaceView } from './SpaceView';
import { useDark, useFrame, useSamples, useSize } from './useSamples';
import { useWheel } from './useWheel';

const withoutWebGl = 'This browser shows nothing in 3D: WebGL is missing or turned off. Choose the kind “map” at Fields, which shows the same from above.';

/** The view of a panel on its canvas; the poses that it shows as words. */
function useSpace(panel: Panel, paused: boolean) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const words = useRef<HTMLParagraphElement>(null);
  const [space] = useState(() => new SpaceView(panel));
  space.panel = panel;
  const [follow, setFollow] = useState(false);
  const [problem, setProblem] = useState('');
  const dark = useDark();
  const draw = useFrame(() => {
    const poses = canvas.current && space.draw(canvas.current, dark, follow);
    if (poses && words.current) words.current.textContent = poses.map(poseText).join('; ');
  });
  useEffect(() => {
    if (!canvas.current) return;
    try {
      space.open(canvas.current);
    } catch {
      setProblem(withoutWebGl);
    }
    draw();
    return () => space.close();
  }, [space, draw]);
  const state = useSamples(panel.sources, paused, (document, time, sample) => [space.take(document, time, sample), draw()]);
  const sources = JSON.stringify(panel.sources);
  useEffect(() => {
    space.reset();
    draw();
  }, [space, sources, draw]);
  useEffect(draw, [draw, dark, follow]);
  useSize(canvas, draw);
  const change = (next: (before: Orbit) => Orbit) => [space.change(next), draw()];
  const fit = () => [space.fit(), setFollow(false), draw()];
  return { canvas, words, change, fit, follow, setFollow, state, problem };
}

/** Dragging turns the camera; with Shift, or by another button, it moves. */
function useDragging(turn: (x: number, y: number) => void, move: (x: number, y: number) => void) {
  const drag = useRef<{ x: number; y: number; moves: boolean } | null>(null);
  const end = () => {
    drag.current = null;
  };
  return {
    onPointerDown: (event: PointerEvent) => {
      event.currentTarget.setPointerCapture(event.pointerId);
      drag.current = { x: event.clientX, y: event.clientY, moves: event.shiftKey || event.button !== 0 };
    },
    onPointerMove: (event: PointerEvent) => {
      if (!drag.current) return;
      const { x, y, moves } = drag.current;
      (moves ? move : turn)(event.clientX - x, event.clientY - y);
      drag.current = { x: event.clientX, y: event.clientY, moves };
    },
    onPointerUp: end,
    onPointerCancel: end,
    onContextMenu: (event: { preventDefault: () => void }) => event.preventDefault(),
  };
}

/** Poses with their trails, paths, scans and grids in 3D. */
export function SpacePanel({ panel, paused }: { panel: Panel; paused: boolean }) {
  const { canvas, words, change, fit, follow, setFollow, state, problem } = useSpace(panel, paused);
  const turn = (yaw: number, pitch: number) => change((before) => turned(before, yaw, pitch));
  const zoom = (factor: number) => change((before) => nearer(before, factor));
  const move = (right: number, forward: number) => [setFollow(false), change((before) => moved(before, right, forward))];
  const drag = useDragging((x, y) => turn(-x * 0.008, y * 0.008), (x, y) => move(-x * 0.002, y * 0.002));
  useWheel(canvas, (event) => zoom(Math.exp(-event.deltaY * 0.0015)));
  const press = (event: KeyboardEvent) => {
    const [right, up] = [Number(event.key === 'ArrowRight') - Number(event.key === 'ArrowLeft'), Number(event.key === 'ArrowUp') - Number(event.key === 'ArrowDown')];
    if ((right !== 0 || up !== 0) && event.shiftKey) move(right * 0.1, up * 0.1);
    else if (right !== 0 || up !== 0) turn(right * 0.15, up * 0.1);
    else if (event.key === '+') zoom(1.25);
    else if (event.key === '-') zoom(1 / 1.25);
    else return;
    event.preventDefault();
  };
  return (
    <>
      <div className="panel-tools">
        <button type="button" className="small" aria-label="Zoom in" onClick={() => zoom(1.25)}>+</button>
        <button type="button" className="small" aria-label="Zoom out" onClick={() => zoom(1 / 1.25)}>−</button>
        <button type="button" className="small" onClick={fit}>All</button>
        <label><input type="checkbox" checked={follow} onChange={(event) => [change((before) => before), setFollow(event.target.checked)]} /> follow</label>
        <p className="quiet" ref={words} />
      </div>
      {problem && <p className="empty" role="status">{problem}</p>}
      <canvas
        ref={canvas} className="map" hidden={problem !== ''} role="img" tabIndex={0} {...drag} onKeyDown={press}
        aria-label={'3D view of ' + panel.sources.map(sourceText).join(', ') + '; arrow keys turn it, with Shift they move it, plus and minus zoom'}
      />
      <Footer state={state} paused={paused} />
    </>
  );
}
