// SPDX-License-Identifier: Apache-2.0
import type { Direction } from './robot/types';

/** A port as everywhere on the page: "→ scan" is an input and "velocity →" an output, as in graphs, where data goes from left to right. */
export function PortName({ name, direction }: { name: string; direction: Direction }) {
  return (
    <span className="port-name">
      <span className="hidden">{direction} </span>
      {direction === 'input' && <span aria-hidden="true">→ </span>}
      {name}
      {direction === 'output' && <span aria-hidden="true"> →</span>}
    </span>
  );
}
