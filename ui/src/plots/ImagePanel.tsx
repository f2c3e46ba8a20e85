// SPDX-License-Identifier: Apache-2.0
import { useRef, useState } from 'react';
import { valueAt } from './fields';
import { Footer } from './Footer';
import type { Panel } from './layout';
import { imagePixels } from './map';
import { useSamples } from './useSamples';

/** The newest image of a port. */
export function ImagePanel({ panel, paused }: { panel: Panel; paused: boolean }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [note, setNote] = useState({ text: '', problem: '' });
  const state = useSamples(panel.sources, paused, (_document, _time, sample) => {
    const image = imagePixels(valueAt(sample, panel.sources[0]?.path ?? []));
    if (typeof image === 'string') return setNote({ text: '', problem: image });
    const place = canvas.current;
    const context = place?.getContext('2d');
    if (!place || !context) return;
    if (place.width !== image.width) place.width = image.width;
    if (place.height !== image.height) place.height = image.height;
    context.putImageData(new ImageData(image.pixels as Uint8ClampedArray<ArrayBuffer>, image.width, image.height), 0, 0);
    const text = image.width + ' × ' + image.height + ' pixels';
    setNote((before) => (before.text === text && before.problem === '' ? before : { text, problem: '' }));
  });
  return (
    <>
      <div className="panel-tools quiet">{note.text}</div>
      <div className="picture">
        <canvas ref={canvas} width={1} height={1} role="img" aria-label={'Image of ' + panel.title + (note.text ? ', ' + note.text : '')} />
      </div>
      <Footer state={state} paused={paused} problem={note.problem} />
    </>
  );
}
