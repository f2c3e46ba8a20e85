// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { labelBox, placeLabels } from './labels';

const level = (y: number) => [{ x: 0, y }, { x: 400, y }];

it('labels lie on no box and on no other label, or are left out', () => {
  const layout = { boxes: new Map(), routes: new Map([['a', level(50)], ['b', level(52)], ['c', level(150)]]), labels: new Map(), size: { width: 400, height: 200 } };
  const box = { x: 150, y: 40, width: 100, height: 20 };
  const wall = { x: 0, y: 130, width: 400, height: 40 };
  placeLabels(layout, [box, wall], ['a', 'b', 'c'].map((id) => ({ id, source: id, target: id, labelWidth: 80 })));
  expect([...layout.labels.keys()]).toEqual(['a', 'b']);
  const [a, b] = ['a', 'b'].map((id) => labelBox(layout.labels.get(id) ?? { x: 0, y: 0 }, 80)) as [ReturnType<typeof labelBox>, ReturnType<typeof labelBox>];
  expect(Math.abs(a.x - b.x)).toBeGreaterThanOrEqual(80);
  for (const one of [a, b]) expect(one.x + one.width <= box.x || one.x >= box.x + box.width).toBe(true);
});
